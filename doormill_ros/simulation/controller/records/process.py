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
from doormill_ros.toolpath.program import RACK_KINDS, MillingProgram

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
    """The wrench that the milling program was corrected for, along every motion."""
    places = [target.T_base_tool_corrected[:3, 3] for target in milling.targets]

    def wrench_of(context: MotionContext, T_base_tool: FloatArray, _direction: FloatArray) -> FloatArray:
        motion = milling.motions[context.index]
        if motion.wrench_end is None:
            return np.broadcast_to(motion.wrench, (len(T_base_tool), 6))
        start, end = places[milling.motions[context.index - 1].target], places[motion.target]
        via = None if motion.via is None else places[motion.via]
        share = _share_of_way(T_base_tool[:, :3, 3], start, via, end)
        return motion.wrench_at(share)

    return wrench_of


def _share_of_way(
    points: FloatArray, start: FloatArray, via: FloatArray | None, end: FloatArray
) -> FloatArray:
    """How much of a line or arc lies behind points on it or near it, 0..1; shapes (n, 3), (3,) each -> (n,)."""
    behind = np.linalg.norm(points - start, axis=1)
    ahead = np.linalg.norm(points - end, axis=1)
    half = 0.0
    if via is not None:
        # The circle point sees the two ends under a straight angle less half of what the arc turns by.
        a, b = via - start, end - via
        half = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
    if half < 1e-6:
        straight: FloatArray = behind / np.maximum(behind + ahead, 1e-12)
        return straight
    # Chords are as the sines of half of what their arcs turn by.
    share: FloatArray = np.arctan2(behind * np.sin(half), ahead + behind * np.cos(half)) / half
    return share


def module_process(milling: MillingProgram | None = None, wrench_of: WrenchOf | None = None) -> Process:
    """The cut while the project's own module runs.

    Args:
        milling: Program whose wrenches act; None cuts air unless `wrench_of` is given.
        wrench_of: Wrenches of another origin than the program's own.
    """
    own = wrench_of_program(milling) if milling is not None else no_wrench
    return Process(module_context, wrench_of or own)


def listed_process(milling: MillingProgram, wrench_of: WrenchOf | None = None) -> Process:
    """The cut while a program without our data runs, such as the thesis'.

    Args:
        milling: Its motions, but for what is done at a rack, are the program's motion instructions in turn.
        wrench_of: Wrenches of another origin than the program's own.
    """
    moved = [i for i, motion in enumerate(milling.motions) if motion.kind not in RACK_KINDS]

    def context_of(_program: RapidProgram, count: int) -> MotionContext:
        if not 0 <= count < len(moved):
            return MotionContext()
        index = moved[count]
        motion = milling.motions[index]
        return MotionContext(index, motion.feature, motion.cutting)

    return Process(context_of, wrench_of or wrench_of_program(milling))
