"""Base of every error that bad input can cause, and the list of all codes.

Each room keeps its errors in a module named `errors` (or `..._errors`): a class of its own where code decides by
it or where it carries more than the sentence, a row made by `DoormillError.row` for every other code.
Messages and action results carry the code as `error_code`; docs/errors.md lists all of them.
"""

from __future__ import annotations

import copyreg
import importlib
import pkgutil
import sys
from typing import Any, NamedTuple, Self, cast

# First code, what the hundred is about, and the codes that a short list shows.
RANGES = (
    (100, "recipe", (105, 140)),
    (200, "localization", (201, 204)),
    (300, "path", (310, 320)),
    (400, "ABB controller", (407, 450, 491)),
    (500, "measured data, models made from it", (502, 503)),
    (600, "bags, backups", (603, 651)),
    (700, "robot", (701, 703)),
    (800, "the run", (801, 802)),
)

LONGEST = 1000  #: characters of a sentence; the middle of a longer one is left out


class DoormillError(Exception):
    """Anything without a code of its own.

    The message is one sentence about the input: what, found, allowed, what to do.

    Attributes:
        code: Stable number of the error class; 0 is reserved for success.
        data: The offending values by name, for logs and messages.
    """

    code: int = 1

    def __init__(self, message: str, **data: Any) -> None:
        """Keep the sentence, on one line and no longer than a log takes, and the offending values."""
        message = one_line(message)
        super().__init__(message)
        self.message = message
        self.data = data

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle without the constructor: a subclass may ask it for more than the sentence."""
        return copyreg.__newobj__, (type(self), *self.args), self.__dict__  # type: ignore[attr-defined]  # no stub

    @classmethod
    def row(cls, name: str, code: int, sentence: str, **attributes: object) -> type[Self]:
        """A leaf class below this one, as a row of a table of errors.

        Assign it to a module's variable of the same name: `LateError = CellError.row("LateError", 899, "Too late.")`.

        Args:
            name: Name of the class.
            code: Its code, given to no other class.
            sentence: What went wrong; becomes the docstring.
            attributes: Class attributes that the base declares and the leaf sets otherwise.
        """
        module = sys._getframe(1).f_globals["__name__"]
        members = {"code": code, "__doc__": sentence, "__module__": module, **attributes}
        return cast("type[Self]", type(name, (cls,), members))


def one_line(message: str) -> str:
    """What a file holds, or a library says of it, stands in the sentence: it may be of any length and form."""
    if not message.isprintable():
        message = " ".join("".join(c if c.isprintable() else " " for c in message).split())
    if len(message) > LONGEST:
        message = f"{message[: LONGEST - 300]} ... {message[-295:]}"
    return message


def unexpected(error: Exception) -> str:
    """The beginning of a sentence about an error that nobody thought of; what to do follows it."""
    return f"unexpected {type(error).__name__}: {error}"


class DataSetError(DoormillError):
    """Measured data, or a model made from it, that cannot be used."""

    code = 500


class ErrorCode(NamedTuple):
    """One line of the list of codes."""

    code: int
    name: str  # of the class
    room: str  # folder of the package that raises it, such as "abb" or "localization/sensors"
    sentence: str


def error_classes() -> list[type[DoormillError]]:
    """Every error class of the package, bases included."""
    package = __name__.rpartition(".")[0]
    for module in pkgutil.walk_packages(sys.modules[package].__path__, f"{package}."):
        if module.name.endswith("errors"):
            importlib.import_module(module.name)

    def below(cls: type[DoormillError]) -> list[type[DoormillError]]:
        return [cls] + [leaf for child in cls.__subclasses__() for leaf in below(child)]

    return [cls for cls in below(DoormillError) if cls.__module__.startswith(f"{package}.")]


def catalogue() -> list[ErrorCode]:
    """Every code with its class, its room and what it says, in the order of the codes."""
    return sorted(
        ErrorCode(
            cls.code,
            cls.__name__,
            "/".join(cls.__module__.split(".")[1:-1]),
            (cls.__doc__ or "").partition("\n")[0],
        )
        for cls in error_classes()
        if "code" in vars(cls)
    )
