"""The base of a robot displaced and turned while a series was recorded, by six numbers and a course over its rows."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.causes.cause import Columns, PoseCause, Reported
from doormill_ros.robot_model.pose.chain import Placement, direction
from doormill_ros.robot_model.pose.view import SetView


class MovedBase(PoseCause):
    """Of one series, 'set NAME'; its numbers are three displacements and three turns in base axes."""

    of_robot = False
    timed = True

    @abstractmethod
    def course_over(self, view: SetView) -> FloatArray:
        """Share of it at each row of the series, shape (n,)."""

    def columns(self, view: SetView) -> list[Columns]:
        """Displacement of the base, in base axes."""
        if f"set {view.name}" != self.where:
            return []
        share = self.course_over(view)[:, None]
        return [Columns(direction(0, axis), axis, share) for axis in range(6)]

    def seen_in(self, seen: Sequence[tuple[SetView, Placement]]) -> tuple[SetView, Placement]:
        """Its series among all."""
        return next(one for one in seen if self.where == f"set {one[0].name}")

    def in_tracker(self, displacement: str, x: FloatArray, std: FloatArray, placement: Placement) -> Reported:
        """Its numbers and their deviations, shape (6,), in axes of the tracker, the displacement by its name."""
        R_tracker_base = placement.T_tracker_base[:3, :3]
        return {
            name: {
                "value": [float(v) for v in R_tracker_base @ x[axes]],
                "std": [float(v) for v in np.sqrt(R_tracker_base**2 @ std[axes] ** 2)],
                "unit": self.coefficients[axes.start].unit,
                "axes": "tracker",
            }
            for name, axes in ((displacement, slice(0, 3)), ("turn", slice(3, 6)))
        }
