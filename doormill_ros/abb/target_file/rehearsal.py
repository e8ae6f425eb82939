"""A program of nothing, rendered and read back: what happens at first use is over when the first door comes."""

from __future__ import annotations

import numpy as np

from doormill_ros.abb.target_file.target_file import check_handover, render_target_file
from doormill_ros.robot.configuration import ConfData
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target

NAME = "rehearsal"
_POSE, _NOTHING = np.eye(4), np.zeros(6)
_TARGET = Target(NAME, _POSE, _POSE, _NOTHING, ConfData(0, 0, 0, 0), _NOTHING, _NOTHING)
_WAY = [(MotionKind.ABSOLUTE, None, ""), (MotionKind.LINEAR, None, NAME), (MotionKind.CIRCULAR, 1, NAME)]
#: One target of each kind of motion, the robot where all its joints are zero. It leaves this process in no way.
PROGRAM = MillingProgram(
    door_id=NAME,
    recipe_version=1,
    targets=(_TARGET, _TARGET, _TARGET),
    motions=tuple(
        Motion(kind, target, via, 0.1, "fine", feature, bool(feature))
        for target, (kind, via, feature) in zip((0, 0, 2), _WAY, strict=True)
    ),
    points=(_NOTHING,),
    home=_NOTHING,
    escapes=(range(1),),
    tool=_POSE,
)


def rehearse(program: MillingProgram = PROGRAM) -> None:
    """Render and check a file of a program.

    Raises:
        AbbError: The program cannot be written.
    """
    check_handover(render_target_file(program, NAME), NAME, program.door_id)
