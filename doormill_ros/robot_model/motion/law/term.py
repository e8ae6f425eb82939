"""One term of a law without a name between motor and link."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import number_of
from doormill_ros.robot_model.law.term import Term
from doormill_ros.robot_model.motion.law.carriers import CARRIERS
from doormill_ros.robot_model.motion.law.drivers import DRIVERS
from doormill_ros.robot_model.motion.law.ride import Ride

#: Recordings of one joint.
Rides = tuple[Ride, ...]


class MotionTerm(Term[Rides]):
    """A difference of the encoders: a carrier's, times a shape of what drives it."""

    carriers, drivers = CARRIERS, DRIVERS

    @classmethod
    def values_of(cls, case: Rides, where: str, driver: str) -> FloatArray:
        """In each sample of all recordings, shape (n,)."""
        return np.concatenate([DRIVERS.reading(driver, ride, number_of(where)) for ride in case])

    def effect(self, case: Rides) -> FloatArray:
        """Link minus motor angle for a unit of every theta, shape (n, 1, p)."""
        motion = np.concatenate([self.carrier.motion(ride) for ride in case])
        return (self.carrier.size * motion[:, None] * self.followed(case))[:, None, :]
