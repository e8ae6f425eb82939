"""What can be off between motor and link, as link minus motor angle for one unit of it: one line a carrier."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import Carrier
from doormill_ros.robot_model.motion.law.ride import Ride
from doormill_ros.units import mm_to_m

#: Of a recording: link minus motor angle for one unit, shape (n,) [rad].
Motion = Callable[[Ride], FloatArray]

#: Ways that bristles bend before they slide [mrad], and times in which a spring goes on yielding [s].
BRISTLES = (0.1, 0.3, 1.0, 3.0)
SETTLES = (0.15, 0.3, 0.6, 1.2, 2.5, 5.0)


def _bristles(width: float) -> Motion:
    return lambda ride: ride.own.slip(mm_to_m(width), 0.0)


def _yielding(settles: float) -> Motion:
    return lambda ride: ride.late_spring(settles)


#: Carriers by what they act on, as in diagnosis.json.
CARRIERS: dict[str, Carrier[Motion]] = {
    "joint angle": Carrier(lambda ride: np.ones(len(ride)), "rad", 1e-5, "differs from its motor"),
    "spring": Carrier(lambda ride: ride.spring, "1", 0.05, "gives way more"),
    "delay": Carrier(lambda ride: -ride.own.speed, "s", 1e-4, "is read late"),
    **{
        f"friction within {width:g} mrad": Carrier(_bristles(width), "rad", 1e-5, "lags by its friction")
        for width in BRISTLES
    },
    **{
        f"spring that yields in {time:g} s": Carrier(_yielding(time), "1", 0.05, "gives way later")
        for time in SETTLES
    },
}
