"""What the simulated controller is told beside the program: which motion cuts, and how hard.

The target file carries no forces, and the thesis' program does not say which motion cuts. A
`Process` answers both: `context_of(program, count)` when the program pointer meets the motion
instruction number `count` (from 0), `wrench_of(context, T_base_tool, direction)` for the samples of
a motion that cuts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.moves import MotionContext
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.toolpath.program import MillingProgram

#: Data of rapid/DoorMill.mod that tell what is being milled.
MOTION_DATA, FEATURE_DATA, CUTTING_DATA = "millingMotion", "millingFeature", "millingCutting"

ContextOf = Callable[[RapidProgram, int], MotionContext]
#: (context, T_base_tool (n, 4, 4), direction of travel (n, 3)) -> wrench on the tool at the tool
#: centre point, base axes, shape (n, 6) [N, N m].
WrenchOf = Callable[[MotionContext, FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class Process:
    """The cut, as the simulation needs it."""

    context_of: ContextOf
    wrench_of: WrenchOf


def module_context(program: RapidProgram, _count: int) -> MotionContext:
    """What the project's own RAPID module says it is about to do; a motion of no feature elsewhere."""
    if not program.has_data(MOTION_DATA):
        return MotionContext()
    return MotionContext(
        index=int(program.read(MOTION_DATA)) - 1,
        feature=str(program.read(FEATURE_DATA)),
        cutting=bool(program.read(CUTTING_DATA)),
    )


def no_wrench(_context: MotionContext, T_base_tool: FloatArray, _direction: FloatArray) -> FloatArray:
    """Cutting air: zeros, shape (n, 6) [N, N m], for poses (n, 4, 4)."""
    return np.zeros((len(T_base_tool), 6))


def wrench_of_program(milling: MillingProgram) -> WrenchOf:
    """The wrench that the milling program was corrected for, motion by motion."""

    def wrench_of(context: MotionContext, T_base_tool: FloatArray, _direction: FloatArray) -> FloatArray:
        return np.broadcast_to(milling.motions[context.index].wrench, (len(T_base_tool), 6))

    return wrench_of


def module_process(milling: MillingProgram | None = None, wrench_of: WrenchOf | None = None) -> Process:
    """The cut while the project's own module runs.

    Args:
        milling: Program whose wrenches act; None cuts air unless `wrench_of` is given.
        wrench_of: Wrenches of another origin than the program's own.
    """
    own = wrench_of_program(milling) if milling is not None else no_wrench
    return Process(module_context, wrench_of or own)


def listed_process(milling: MillingProgram, first: int = 1, wrench_of: WrenchOf | None = None) -> Process:
    """The cut while a program without our data runs, such as the thesis'.

    Args:
        milling: Its motions are the program's motion instructions from number `first` on.
        first: Motion instructions before that, such as the one to the home position.
        wrench_of: Wrenches of another origin than the program's own.
    """

    def context_of(_program: RapidProgram, count: int) -> MotionContext:
        index = count - first
        if not 0 <= index < len(milling.motions):
            return MotionContext()
        motion = milling.motions[index]
        return MotionContext(index, motion.feature, motion.cutting)

    return Process(context_of, wrench_of or wrench_of_program(milling))
