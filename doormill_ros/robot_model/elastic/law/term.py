"""One term of a law without a name in a loading test."""

from __future__ import annotations

from typing import Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.causes.cause import LinearTwist
from doormill_ros.robot_model.elastic.law.carriers import CARRIERS
from doormill_ros.robot_model.elastic.law.cracks import OPENING
from doormill_ros.robot_model.elastic.law.drivers import DRIVERS
from doormill_ros.robot_model.elastic.law.memory import FRICTIONS
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.law.parts import number_of
from doormill_ros.robot_model.law.term import SeenRange, Term, seen_in


class LawTerm(Term[LoadCase], LinearTwist):
    """A twist of the measured point: a carrier's, times a shape of what drives it."""

    carriers, drivers = CARRIERS, DRIVERS

    def __init__(
        self, where: str, acts_on: str, driver: str, shape: str, numbers: tuple[float, ...], seen: SeenRange
    ) -> None:
        """As every term; what opens or remembers is one thing in many readings, as numbers of waves are."""
        super().__init__(where, acts_on, driver, shape, numbers, seen)
        if acts_on in OPENING:
            self.name, self.variant = f"{OPENING[acts_on].kind}: {shape}", f"{acts_on}, {self.variant}"
        elif driver in FRICTIONS:
            self.name, self.variant = f"{acts_on} behind friction: {shape}", driver

    @classmethod
    def values_of(cls, case: LoadCase, where: str, driver: str) -> FloatArray:
        """In each loading, shape (n,)."""
        return DRIVERS.reading(driver, case, number_of(where))

    def neighbours(self, case: LoadCase) -> list[Self]:
        """Also the same over the edges and cracks next to its own, or behind friction of the limits next to its own."""
        found = super().neighbours(case)
        for friction in FRICTIONS[self.driver].beside() if self.driver in FRICTIONS else ():
            seen = seen_in(self.values_of(case, self.where, friction.driver), self.shape, self.numbers)
            if seen is not None:
                found.append(
                    type(self)(self.where, self.acts_on, friction.driver, self.shape, self.numbers, seen)
                )
        for other in OPENING[self.acts_on].beside() if self.acts_on in OPENING else ():
            values = self.values_of(case, self.where, other.driver)
            numbers = (self.numbers[0], max(float(values.max()), 1e-9))
            seen = seen_in(values, self.shape, numbers)
            if seen is not None:
                found.append(type(self)(self.where, other.acts_on, other.driver, self.shape, numbers, seen))
        return found

    def unit(self, case: LoadCase) -> FloatArray:
        """Every component of the carrier times every column of the shape."""
        key = ("law", self.where, self.acts_on)
        if key not in case.cache:
            case.cache[key] = np.stack(self.carrier.motion(case, self.where), axis=2)
        shape = self.followed(case)
        motion = self.carrier.size * case.cache[key]
        return (motion[:, :, :, None] * shape[:, None, None, :]).reshape(len(case), 6, -1)
