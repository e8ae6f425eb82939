"""The mark of a predefined routine: the head under which RAPID documents it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

#: (head, function) in the order of import.
ROUTINES: list[tuple[str, Callable[..., Any]]] = []


def predefined(head: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    r"""Register a function as a RAPID routine.

    The function takes the context and one argument for each parameter: a value; True or False for
    a switch; None for an optional argument that was not given; (list, index) for VAR, PERS and
    INOUT; (value, type) or (list, index, type) for anytype.

    Args:
        head: As RAPID writes it, for example `FUNC num StrLen(string Str)`.
    """

    def register(function: Callable[..., Any]) -> Callable[..., Any]:
        ROUTINES.append((head, function))
        return function

    return register
