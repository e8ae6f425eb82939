"""What can drive an effect in a moving joint: one line a driver; brackets tell two readings of one driver apart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import Driver, Drivers
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
DRIVERS: Drivers[Ride] = Drivers(
    named={
        "constant": Driver(lambda ride, joint: np.ones(len(ride)), ""),
        "own angle": _JOINT["angle"],
        "own torque": _JOINT["torque"],
        "torque sign": Driver(_of(lambda seen: np.sign(seen.torque)), ""),
        "direction": Driver(_of(lambda seen: np.tanh(seen.speed / _CREEPS)), ""),
        "speed": _JOINT["speed"],
        "speed (its change)": Driver(_of(lambda seen: seen.acceleration), "rad / s^2"),
        "time": Driver(lambda ride, joint: ride.own.time, "s", False),
        "time under load": Driver(lambda ride, joint: np.ones(len(ride)), "", False),
    },
    of_joint=_JOINT,
)
