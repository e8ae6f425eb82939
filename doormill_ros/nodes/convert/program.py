"""Milling programs."""

from __future__ import annotations

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


def program_into(message: TargetArray, program: MillingProgram) -> TargetArray:
    """Fill a message with targets and motions; returns it.

    Generated constructors make every default even where a value is given, and a door has tens of
    thousands of nested messages: each is made once and filled in place.
    """
    message.door_id = program.door_id
    message.recipe_version = program.recipe_version
    message.largest_correction = program.largest_correction
    message.expected_error = program.expected_error
    targets = program.targets
    nominal = pose_values([t.T_base_tool_nominal for t in targets])
    corrected = pose_values([t.T_base_tool_corrected for t in targets])
    wrench, deflection = (_rows([getattr(t, name) for t in targets]) for name in ("wrench", "deflection"))
    columns = zip(targets, nominal, corrected, wrench, deflection, strict=True)
    message.targets = [_target(*row) for row in columns]
    motions = program.motions
    begin, end = _rows([m.wrench for m in motions]), _rows([m.last_wrench for m in motions])
    message.motions = [_motion(*row) for row in zip(motions, begin, end, strict=True)]
    message.points = [JointPoint(joint_positions=np.asarray(q, dtype=float)) for q in program.points]
    message.home = [] if program.home is None else np.asarray(program.home, dtype=float).tolist()
    message.escapes = [
        Escape(feature=feature, first=escape.start, last=escape.stop - 1)
        for feature, escape in zip(program.features, program.escapes, strict=bool(program.escapes))
    ]
    return message


def _rows(values: list[FloatArray]) -> list[list[float]]:
    """Each of many arrays of shape (6,) as numbers."""
    rows: list[list[float]] = np.array(values, dtype=float).tolist()
    return rows


def _target(
    target: Target, nominal: list[float], corrected: list[float], wrench: list[float], deflection: list[float]
) -> TargetMessage:
    message = TargetMessage()
    message.name = target.name
    fill_pose(message.nominal, nominal)
    fill_pose(message.corrected, corrected)
    message.joint_positions = np.asarray(target.q, dtype=float)
    conf = target.conf
    message.cf1, message.cf4, message.cf6, message.cfx = conf.cf1, conf.cf4, conf.cf6, conf.cfx
    _fill_pair(message.wrench.force, message.wrench.torque, wrench)
    _fill_pair(message.deflection.linear, message.deflection.angular, deflection)
    message.expected_error = float(target.expected_error)
    return message


def _motion(motion: Motion, begin: list[float], end: list[float]) -> MotionMessage:
    message = MotionMessage()
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
    return message


def _fill_pair(first: Vector3, second: Vector3, values: list[float]) -> None:
    first.x, first.y, first.z, second.x, second.y, second.z = values
