"""Milling programs."""

from __future__ import annotations

import numpy as np

from doormill_interfaces.msg import Motion as MotionMessage
from doormill_interfaces.msg import Target as TargetMessage
from doormill_interfaces.msg import TargetArray
from doormill_ros.nodes.convert.geometry import (
    pose_message,
    transform_of,
    twist_message,
    twist_of,
    wrench_message,
    wrench_of,
)
from doormill_ros.toolpath.program import ConfData, MillingProgram, Motion, MotionKind, Target

KINDS = {
    MotionKind.JOINT: MotionMessage.MOVE_J,
    MotionKind.LINEAR: MotionMessage.MOVE_L,
    MotionKind.CIRCULAR: MotionMessage.MOVE_C,
}
KINDS_BACK = {number: kind for kind, number in KINDS.items()}


def program_into(message: TargetArray, program: MillingProgram) -> TargetArray:
    """Fill a message with targets and motions; returns it."""
    message.door_id = program.door_id
    message.recipe_version = program.recipe_version
    message.largest_correction = program.largest_correction
    message.targets = [
        TargetMessage(
            name=t.name,
            nominal=pose_message(t.T_base_tool_nominal),
            corrected=pose_message(t.T_base_tool_corrected),
            joint_positions=np.asarray(t.q, dtype=float),
            cf1=t.conf.cf1,
            cf4=t.conf.cf4,
            cf6=t.conf.cf6,
            cfx=t.conf.cfx,
            wrench=wrench_message(t.wrench),
            deflection=twist_message(t.deflection),
        )
        for t in program.targets
    ]
    message.motions = [
        MotionMessage(
            kind=KINDS[m.kind],
            target=m.target,
            via=-1 if m.via is None else m.via,
            speed=float(m.speed),
            zone=m.zone,
            feature=m.feature,
            cutting=m.cutting,
            wrench=wrench_message(m.wrench),
            spindle_speed=float(m.spindle_speed),
        )
        for m in program.motions
    ]
    return message


def program_of(message: TargetArray) -> MillingProgram:
    """The milling program of an accepted message."""
    targets = tuple(
        Target(
            name=t.name,
            T_base_tool_nominal=transform_of(t.nominal),
            T_base_tool_corrected=transform_of(t.corrected),
            q=np.array(t.joint_positions, dtype=float),
            conf=ConfData(t.cf1, t.cf4, t.cf6, t.cfx),
            wrench=wrench_of(t.wrench),
            deflection=twist_of(t.deflection),
        )
        for t in message.targets
    )
    motions = tuple(
        Motion(
            kind=KINDS_BACK[m.kind],
            target=m.target,
            via=None if m.via < 0 else m.via,
            speed=m.speed,
            zone=m.zone,
            feature=m.feature,
            cutting=m.cutting,
            wrench=wrench_of(m.wrench),
            spindle_speed=m.spindle_speed,
        )
        for m in message.motions
    )
    return MillingProgram(message.door_id, message.recipe_version, targets, motions)
