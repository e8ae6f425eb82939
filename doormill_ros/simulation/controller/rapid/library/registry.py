"""Collects predefined routines under the heads that RAPID documents for them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from doormill_ros.simulation.controller.rapid.parser import parse_signature
from doormill_ros.simulation.controller.rapid.scope import (
    ABSENT,
    Context,
    Frame,
    Names,
    RoutineInfo,
    describe_parameters,
    resolve_type,
)

#: (head, function) in the order of import.
_ROUTINES: list[tuple[str, Callable[..., Any]]] = []


def predefined(head: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    r"""Register a function as a RAPID routine.

    The function takes the context and one argument for each parameter: a value; True or False for
    a switch; None for an optional argument that was not given; (list, index) for VAR, PERS and
    INOUT; (value, type) or (list, index, type) for anytype.

    Args:
        head: As RAPID writes it, for example `FUNC num StrLen(string Str)`.
    """

    def register(function: Callable[..., Any]) -> Callable[..., Any]:
        _ROUTINES.append((head, function))
        return function

    return register


def install(context: Context, types: Names, routines: Names) -> None:
    """Declare every predefined routine for one program."""
    for head, function in _ROUTINES:
        signature = _parsed(head)
        kind = resolve_type(types, signature.type_name, "predefined", 0) if signature.type_name else None
        parameters = describe_parameters(signature, types, "predefined")
        info = RoutineInfo(signature.name, kind, parameters, _adapt(function, context), predefined=True)
        routines.add(signature.name, info)


def _adapt(function: Callable[..., Any], context: Context) -> Callable[[Frame], Any]:
    def run(arguments: Frame) -> Any:
        return function(context, *[None if a is ABSENT else a for a in arguments])

    return run


_CACHE: dict[str, Any] = {}


def _parsed(head: str) -> Any:
    if head not in _CACHE:
        _CACHE[head] = parse_signature(head)
    return _CACHE[head]
