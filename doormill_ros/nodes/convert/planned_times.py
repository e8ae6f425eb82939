"""When each feature of a door is milled, from the targets of its program."""

from __future__ import annotations

import math

import numpy as np

from doormill_interfaces.msg import Motion, TargetArray
from doormill_ros.messages.from_message import positions_of
from doormill_ros.operator.views.door_view import planned_times

_TO_TARGETS = (Motion.MOVE_J, Motion.MOVE_L, Motion.MOVE_C)


def planned_times_of(targets: TargetArray) -> dict[str, tuple[float, float]]:
    """Begin and end by feature, from the start of the program [s]; none where the message makes no sense."""
    places = positions_of(target.nominal.position for target in targets.targets)
    speeds = np.array([motion.speed for motion in targets.motions])
    if not (np.isfinite(places).all() and np.isfinite(speeds).all() and math.isfinite(targets.cycle_time)):
        return {}
    ends = [
        motion.target if motion.kind in _TO_TARGETS and motion.target < len(places) else -1
        for motion in targets.motions
    ]
    return planned_times(
        places, ends, speeds, [motion.feature for motion in targets.motions], targets.cycle_time
    )
