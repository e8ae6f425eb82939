"""Errors inside a running RAPID program: what ERRNO can be, and what no handler may take."""

from __future__ import annotations

from typing import Any

#: Recoverable errors by name; the numbers are the virtual controller's own.
ERROR_NUMBERS: dict[str, int] = {
    name: 1000 + index
    for index, name in enumerate(
        (
            "ERR_ALRDYCNT",
            "ERR_AO_LIM",
            "ERR_ARGVALERR",
            "ERR_DIVZERO",
            "ERR_FILEACC",
            "ERR_FILEEXIST",
            "ERR_FILEOPEN",
            "ERR_FILNOTFND",
            "ERR_GO_LIM",
            "ERR_ILLQUAT",
            "ERR_ILLRAISE",
            "ERR_INOMAX",
            "ERR_MAXINTVAL",
            "ERR_NEGARG",
            "ERR_NORUNUNIT",
            "ERR_NOTPRES",
            "ERR_NUM_LIMIT",
            "ERR_OUTOFBND",
            "ERR_OUTSIDE_REACH",
            "ERR_PATH",
            "ERR_PATHDIST",
            "ERR_PATH_STOP",
            "ERR_PROGSTOP",
            "ERR_ROBLIMIT",
            "ERR_SIG_NOT_VALID",
            "ERR_STRTOOLNG",
            "ERR_TP_DIBREAK",
            "ERR_TP_DOBREAK",
            "ERR_TP_MAXTIME",
            "ERR_TP_PERSBOOLBREAK",
            "ERR_UI_BUTTONS",
            "ERR_UI_ICON",
            "ERR_UI_INITVALUE",
            "ERR_UI_MAXMIN",
            "ERR_UI_NOTINT",
            "ERR_UNKINO",
            "ERR_WAIT_MAXTIME",
        )
    )
}
_NAMES = {number: name for name, number in ERROR_NUMBERS.items()}


def error_name(number: int) -> str:
    """Name of an ERRNO, or its number for one that the program made up."""
    return _NAMES.get(number, str(number))


#: Numbers below are the program's own.
OWN_NUMBERS = 1000


class RapidFault(Exception):
    """A recoverable error: the nearest ERROR clause may handle it.

    Attributes:
        number: What ERRNO becomes.
        reason: What happened, for the event log.
        file: Module file in which it happened; filled in by the interpreter.
        line: Its line.
        escaped: Frame of the routine whose ERROR clause it left; that clause does not take it again.
    """

    def __init__(self, number: int | str, reason: str) -> None:
        """Take an ERRNO or its name."""
        self.escaped: list[Any] | None = None
        self.number = ERROR_NUMBERS[number] if isinstance(number, str) else number
        self.reason = reason
        self.file = ""
        self.line = 0
        super().__init__(f"{error_name(self.number)}: {reason}")

    @property
    def warning(self) -> str:
        """What the event log says when an ERROR clause takes it; empty for an error of the program's own."""
        if self.number < OWN_NUMBERS:
            return ""
        return f"{self.file}, line {self.line}: {error_name(self.number)}: {self.reason}"


class RapidStop(Exception):
    """Execution ends; no handler can take it.

    Attributes:
        reason: Why, empty when the program ended itself.
        file: Module file; filled in by the interpreter.
        line: Its line.
        by_program: True for EXIT and ExitCycle.
        pointer_lost: True for EXIT: the program can only be started from main.
    """

    def __init__(self, reason: str, by_program: bool = False, pointer_lost: bool = False) -> None:
        """Say why."""
        self.reason = reason
        self.by_program = by_program
        self.pointer_lost = pointer_lost
        self.file = ""
        self.line = 0
        super().__init__(reason)
