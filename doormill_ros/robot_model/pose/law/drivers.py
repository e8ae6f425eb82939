"""What can drive an effect in a series of poses: one line a driver; brackets tell two readings of one driver apart."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import Driver, Drivers
from doormill_ros.robot_model.pose.view import SetView


def _known(values: FloatArray | None, view: SetView) -> FloatArray:
    return np.full(len(view), np.nan) if values is None else np.asarray(values, dtype=float)


_JOINT: dict[str, Driver[SetView]] = {
    "angle": Driver(lambda view, k: view.q[:, k], "rad"),
    "torque": Driver(lambda view, k: view.gravity_moment[:, k, 2], "N m"),
    "direction": Driver(lambda view, k: view.last_motion[:, k], ""),
}
DRIVERS: Drivers[SetView] = Drivers(
    named={
        "constant": Driver(lambda view, k: np.ones(len(view)), ""),
        "own angle": _JOINT["angle"],
        "own torque": _JOINT["torque"],
        "torque sign": Driver(lambda view, k: np.sign(view.gravity_moment[:, k, 2]), ""),
        "direction": _JOINT["direction"],
        "time": Driver(lambda view, k: _known(view.time, view), "s", False),
        "temperature": Driver(lambda view, k: _known(view.temperature, view), "deg C", False),
    },
    of_joint=_JOINT,
)
