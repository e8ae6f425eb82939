"""Milling programs."""

from __future__ import annotations

import numpy as np

from doormill_interfaces.msg import Motion as MotionMessage
from doormill_interfaces.msg import Target as TargetMessage
from doormill_interfaces.msg import TargetArray
from doormill_ros.nodes.convert.geometry import pose_message, twist_message, wrench_message
from doormill_ros.recording.messages import program_of
from doormill_ros.toolpath.program import MillingProgram, MotionKind

__all__ = ["program_into", "program_of"]

KINDS = {
    MotionKind.JOINT: MotionMessage.MOVE_J,
    MotionKind.LINEAR: MotionMessage.MOVE_L,
    MotionKind.CIRCULAR: MotionMessage.MOVE_C,
}


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
