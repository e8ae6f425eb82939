"""Milling programs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from geometry_msgs.msg import Vector3

from doormill_interfaces.msg import Escape, JointPoint, TargetArray
from doormill_interfaces.msg import Motion as MotionMessage
from doormill_interfaces.msg import Target as TargetMessage
from doormill_ros.arrays import FloatArray
from doormill_ros.messages.from_message import KINDS as KIND_NUMBERS
from doormill_ros.nodes.convert.geometry import fill_pose, pose_values
from doormill_ros.toolpath.program import MillingProgram, Motion, Target

KINDS = {kind: number for number, kind in enumerate(KIND_NUMBERS)}
Message = TypeVar("Message")


@dataclass(eq=False)
class Nested:
    """Messages of targets and motions that one program after the other is told by; to make them takes longest."""

    targets: list[TargetMessage] = field(default_factory=list)
    motions: list[MotionMessage] = field(default_factory=list)


def program_into(message: TargetArray, program: MillingProgram, nested: Nested | None = None) -> TargetArray:
    """Fill a message with targets and motions; returns it.

    Generated constructors make every default even where a value is given, and a door has tens of
    thousands of nested messages: each is made once and filled in place.

    Args:
        message: To be filled.
        program: With what.
        nested: What the message before was made of and nobody needs any more; None: all is made anew.
    """
    nested = Nested() if nested is None else nested
    message.door_id = program.door_id
    message.recipe_version = program.recipe_version
    message.largest_correction = program.largest_correction
    message.expected_error = program.expected_error
    targets = program.targets
    nominal = pose_values([t.T_base_tool_nominal for t in targets])
    corrected = pose_values([t.T_base_tool_corrected for t in targets])
    wrench, deflection = (_rows([getattr(t, name) for t in targets]) for name in ("wrench", "deflection"))
    message.targets = _first(nested.targets, TargetMessage, len(targets))
    for row in zip(message.targets, targets, nominal, corrected, wrench, deflection, strict=True):
        _fill_target(*row)
    motions = program.motions
    begin, end = _rows([m.wrench for m in motions]), _rows([m.last_wrench for m in motions])
    message.motions = _first(nested.motions, MotionMessage, len(motions))
    for line in zip(message.motions, motions, begin, end, strict=True):
        _fill_motion(*line)
    message.points = [JointPoint(joint_positions=np.asarray(q, dtype=float)) for q in program.points]
    message.home = [] if program.home is None else np.asarray(program.home, dtype=float).tolist()
    message.escapes = [
        Escape(feature=feature, first=escape.start, last=escape.stop - 1)
        for feature, escape in zip(program.features, program.escapes, strict=bool(program.escapes))
    ]
    return message


def _first(made: list[Message], make: Callable[[], Message], count: int) -> list[Message]:
    """So many of those that are made, more of them where there are too few."""
    made.extend(make() for _ in range(len(made), count))
    return made[:count]


def _rows(values: list[FloatArray]) -> list[list[float]]:
    """Each of many arrays of shape (6,) as numbers."""
    rows: list[list[float]] = np.array(values, dtype=float).tolist()
    return rows


def _fill_target(
    message: TargetMessage,
    target: Target,
    nominal: list[float],
    corrected: list[float],
    wrench: list[float],
    deflection: list[float],
) -> None:
    message.name = target.name
    fill_pose(message.nominal, nominal)
    fill_pose(message.corrected, corrected)
    message.joint_positions = np.asarray(target.q, dtype=float)
    conf = target.conf
    message.cf1, message.cf4, message.cf6, message.cfx = conf.cf1, conf.cf4, conf.cf6, conf.cfx
    _fill_pair(message.wrench.force, message.wrench.torque, wrench)
    _fill_pair(message.deflection.linear, message.deflection.angular, deflection)
    message.expected_error = float(target.expected_error)


def _fill_motion(message: MotionMessage, motion: Motion, begin: list[float], end: list[float]) -> None:
    message.kind = KINDS[motion.kind]
    message.target = motion.target
    message.via = -1 if motion.via is None else motion.via
    message.speed = float(motion.speed)
    message.zone = motion.zone
    message.feature = motion.feature
    message.cutting = motion.cutting
    _fill_pair(message.wrench.force, message.wrench.torque, begin)
    _fill_pair(message.wrench_end.force, message.wrench_end.torque, end)
    message.spindle_speed = float(motion.spindle_speed)


def _fill_pair(first: Vector3, second: Vector3, values: list[float]) -> None:
    first.x, first.y, first.z, second.x, second.y, second.z = values
