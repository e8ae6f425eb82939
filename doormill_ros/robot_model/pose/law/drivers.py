"""What can drive an effect in a series of poses: one line a driver; brackets tell two readings of one driver apart."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import Driver, meant
from doormill_ros.robot_model.pose.view import SetView


def _known(values: FloatArray | None, view: SetView) -> FloatArray:
    return np.full(len(view), np.nan) if values is None else np.asarray(values, dtype=float)


_JOINT: dict[str, Driver[SetView]] = {
    "angle": Driver(lambda view, k: view.q[:, k], "rad"),
    "torque": Driver(lambda view, k: view.gravity_moment[:, k, 2], "N m"),
    "direction": Driver(lambda view, k: view.last_motion[:, k], ""),
}
#: Drivers by their names, but for those that name another joint.
DRIVERS: dict[str, Driver[SetView]] = {
    "constant": Driver(lambda view, k: np.ones(len(view)), ""),
    "own angle": _JOINT["angle"],
    "own torque": _JOINT["torque"],
    "torque sign": Driver(lambda view, k: np.sign(view.gravity_moment[:, k, 2]), ""),
    "direction": _JOINT["direction"],
    "time": Driver(lambda view, k: _known(view.time, view), "s", False),
    "temperature": Driver(lambda view, k: _known(view.temperature, view), "deg C", False),
}


def driver(name: str) -> Driver[SetView]:
    """A driver by its name: of DRIVERS, "torque of joint 2", or "direction (of joint 2)".

    Raises:
        KeyError: There is none of that name.
    """
    kind, other = meant(name)
    return DRIVERS[name] if other is None else _JOINT[kind]


def reading(name: str, view: SetView, joint: int) -> FloatArray:
    """Value of a driver in each row for an effect at a joint (0 ..., -1 for none), shape (n,)."""
    other = meant(name)[1]
    return driver(name).reading(view, joint if other is None else other)
