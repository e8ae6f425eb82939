"""The files of predefined routines, and how a program gets them: a new file is one more name in LIBRARY."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.kept import shipped_heads
from doormill_ros.simulation.controller.rapid.library import (
    dialogs,
    files,
    interrupts,
    motion,
    numbers,
    pendant,
    signals,
    strings,
)
from doormill_ros.simulation.controller.rapid.library.predefined import ROUTINES
from doormill_ros.simulation.controller.rapid.scope import (
    ABSENT,
    Frame,
    Names,
    RoutineInfo,
    describe_parameters,
    resolve_type,
)
from doormill_ros.simulation.controller.rapid.types import Value

LIBRARY = (dialogs, files, interrupts, motion, numbers, pendant, signals, strings)


def install(context: Context, types: Names, routines: Names) -> None:
    """Declare every predefined routine for one program."""
    signatures = shipped_heads(tuple(head for head, _ in ROUTINES))
    for (_, function), signature in zip(ROUTINES, signatures, strict=True):
        kind = resolve_type(types, signature.type_name, "predefined", 0) if signature.type_name else None
        parameters = describe_parameters(signature, types, "predefined")
        optional = any(parameter.optional for parameter in parameters)
        run = _adapt(function, context, optional)
        routines.add(signature.name, RoutineInfo(signature.name, kind, parameters, run, predefined=True))


def _adapt(function: Callable[..., Any], context: Context, optional: bool) -> Callable[[Frame], Value]:
    """Code that runs a routine on its argument slots; of `optional` parameters some may be absent."""

    def run(arguments: Frame) -> Value:
        return function(context, *arguments)

    def run_with_absent(arguments: Frame) -> Value:
        return function(context, *[None if a is ABSENT else a for a in arguments])

    return run_with_absent if optional else run
