"""Errors inside a running RAPID program: what ERRNO can be, and what no handler may take."""

from __future__ import annotations

from typing import Any

#: Recoverable errors by name; the numbers are the virtual controller's own.
ERROR_NUMBERS: dict[str, int] = {
    name: 1000 + index
    for index, name in enumerate(
        (
            "ERR_ARGVALERR",
            "ERR_AO_LIM",
            "ERR_DIVZERO",
            "ERR_FILEACC",
            "ERR_FILEEXIST",
            "ERR_FILEOPEN",
            "ERR_FILNOTFND",
            "ERR_ILLQUAT",
            "ERR_MAXINTVAL",
            "ERR_NEGARG",
            "ERR_NOTPRES",
            "ERR_NORUNUNIT",
            "ERR_NUM_LIMIT",
            "ERR_OUTOFBND",
            "ERR_PATH_STOP",
            "ERR_PROGSTOP",
            "ERR_SIG_NOT_VALID",
            "ERR_STRTOOLNG",
            "ERR_WAIT_MAXTIME",
        )
    )
}
_NAMES = {number: name for name, number in ERROR_NUMBERS.items()}


def error_name(number: int) -> str:
    """Name of an ERRNO, or its number for one that the program made up."""
    return _NAMES.get(number, str(number))


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


class RapidStop(Exception):
    """Execution ends; no handler can take it.

    Attributes:
        reason: Why, empty when the program ended itself.
        file: Module file; filled in by the interpreter.
        line: Its line.
        by_program: True for EXIT, Stop and Break.
    """

    def __init__(self, reason: str, by_program: bool = False) -> None:
        """Say why."""
        self.reason = reason
        self.by_program = by_program
        self.file = ""
        self.line = 0
        super().__init__(reason)
