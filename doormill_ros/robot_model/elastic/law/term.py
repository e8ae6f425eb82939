"""One term of a law without a name in a loading test."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.causes.cause import LinearTwist
from doormill_ros.robot_model.elastic.law.carriers import CARRIERS
from doormill_ros.robot_model.elastic.law.drivers import DRIVERS
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.law.parts import number_of
from doormill_ros.robot_model.law.term import Term


class LawTerm(Term[LoadCase], LinearTwist):
    """A twist of the measured point: a carrier's, times a shape of what drives it."""

    carriers, drivers = CARRIERS, DRIVERS

    @classmethod
    def values_of(cls, case: LoadCase, where: str, driver: str) -> FloatArray:
        """In each loading, shape (n,)."""
        return DRIVERS.reading(driver, case, number_of(where))

    def unit(self, case: LoadCase) -> FloatArray:
        """Every component of the carrier times every column of the shape."""
        key = ("law", self.where, self.acts_on)
        if key not in case.cache:
            case.cache[key] = np.stack(self.carrier.motion(case, self.where), axis=2)
        shape = self.followed(case)
        motion = self.carrier.size * case.cache[key]
        return (motion[:, :, :, None] * shape[:, None, None, :]).reshape(len(case), 6, -1)
