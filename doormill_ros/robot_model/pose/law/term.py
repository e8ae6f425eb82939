"""One term of a law without a name in series of poses: it displaces frames as causes do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import number_of
from doormill_ros.robot_model.law.term import Term
from doormill_ros.robot_model.pose.causes.cause import Coefficient, Columns, PoseCause
from doormill_ros.robot_model.pose.law.carriers import CARRIERS
from doormill_ros.robot_model.pose.law.drivers import DRIVERS
from doormill_ros.robot_model.pose.view import SetView


@dataclass(frozen=True, eq=False)
class Sight:
    """Series as terms look at them.

    Attributes:
        views: The series.
        derivatives: Of the poses by every direction of a frame twist, shape (n, directions, axes) for each;
            3 axes where positions alone were measured, else 6.
    """

    views: tuple[SetView, ...]
    derivatives: tuple[FloatArray, ...] = ()


class PoseTerm(Term[Sight], PoseCause):
    """A displacement of frames: a carrier's, times a shape of what drives it."""

    carriers, drivers = CARRIERS, DRIVERS

    @property
    def lasts(self) -> bool:
        """Whether it holds beyond its series: a base that moves with the clock does not."""
        return self.of_robot or self.drives.of_path

    @classmethod
    def values_of(cls, case: Sight, where: str, driver: str) -> FloatArray:
        """In each row of all series, shape (n,)."""
        return np.concatenate([DRIVERS.reading(driver, view, number_of(where)) for view in case.views])

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Every weight, in typical amplitudes."""
        return tuple(Coefficient(f"weight_{i + 1}", "1", repr(self), 1e3) for i in range(self.size))

    def columns(self, view: SetView) -> list[Columns]:
        """For a unit of every theta."""
        shape = self.carrier.size * self.followed(Sight((view,)))
        return [
            Columns(direction, i * shape.shape[1], size[:, None] * shape)
            for i, (direction, size) in enumerate(self.carrier.motion(view, self.where))
        ]

    def effect(self, case: Sight) -> FloatArray:
        """Displacement of the poses for a unit of every theta, base axes, shape (n, axes, p)."""
        found = []
        for view, D in zip(case.views, case.derivatives, strict=True):
            part = np.zeros((len(view), D.shape[2], self.size))
            for own in self.columns(view):
                here = slice(own.first, own.first + own.basis.shape[1])
                part[:, :, here] += D[:, own.direction, :, None] * own.basis[:, None, :]
            found.append(part)
        return np.concatenate(found)
