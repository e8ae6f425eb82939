"""What can drive an effect in a moving joint: one line a driver; brackets tell two readings of one driver apart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import Driver, meant
from doormill_ros.robot_model.motion.law.ride import Ride
from doormill_ros.robot_model.motion.view import SeenMotion

#: Speed from which a joint certainly moves one way [rad / s].
_CREEPS = 5e-3


def _of(what: Callable[[SeenMotion], FloatArray]) -> Callable[[Ride, int], FloatArray]:
    """Of the joint that is meant; unknown where that was not recorded."""

    def reading(ride: Ride, joint: int) -> FloatArray:
        seen = ride.of(joint)
        return np.full(len(ride), np.nan) if seen is None else what(seen)

    return reading


_JOINT: dict[str, Driver[Ride]] = {
    "angle": Driver(_of(lambda seen: seen.motor), "rad"),
    "torque": Driver(_of(lambda seen: seen.torque), "N m"),
    "speed": Driver(_of(lambda seen: seen.speed), "rad / s"),
}
#: Drivers by their names, but for those that name another joint.
DRIVERS: dict[str, Driver[Ride]] = {
    "constant": Driver(lambda ride, joint: np.ones(len(ride)), ""),
    "own angle": _JOINT["angle"],
    "own torque": _JOINT["torque"],
    "torque sign": Driver(_of(lambda seen: np.sign(seen.torque)), ""),
    "direction": Driver(_of(lambda seen: np.tanh(seen.speed / _CREEPS)), ""),
    "speed": _JOINT["speed"],
    "speed (its change)": Driver(_of(lambda seen: seen.acceleration), "rad / s^2"),
    "time": Driver(lambda ride, joint: ride.own.time, "s", False),
    "time under load": Driver(lambda ride, joint: np.ones(len(ride)), "", False),
}


def driver(name: str) -> Driver[Ride]:
    """A driver by its name: of DRIVERS, "torque of joint 2", or "speed (of joint 2)".

    Raises:
        KeyError: There is none of that name.
    """
    kind, other = meant(name)
    return DRIVERS[name] if other is None else _JOINT[kind]


def reading(name: str, ride: Ride, joint: int) -> FloatArray:
    """Value of a driver in each sample for an effect at a joint (0 ... 5), shape (n,)."""
    other = meant(name)[1]
    return driver(name).reading(ride, joint if other is None else other)
