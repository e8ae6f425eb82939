"""A cell that warms up or creeps while a series is recorded, by one course from its first row to its last."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.causes.cause import Coefficient, PoseCause, Reported
from doormill_ros.robot_model.pose.causes.hints import Hints, TimeCourse
from doormill_ros.robot_model.pose.causes.moved_base import MovedBase
from doormill_ros.robot_model.pose.chain import Placement
from doormill_ros.robot_model.pose.view import SetView


class PoseSettling(MovedBase):
    """Displacement of the robot's base that grows as one minus a decay does, or steadily.

    Attributes:
        course: How it grows.
    """

    name = "thermal_drift"

    def __init__(self, where: str, course: TimeCourse) -> None:
        """Put it on a series ('set NAME')."""
        super().__init__(where)
        self.course = course

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """On every series in which one is suspected."""
        return [cls(f"set {hints.sets[index].name}", course) for index, course in hints.courses.items()]

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """What it comes to from the first row to the last: three displacements, three turns."""
        names = [("x", "m"), ("y", "m"), ("z", "m"), ("turn_x", "rad"), ("turn_y", "rad"), ("turn_z", "rad")]
        return tuple(Coefficient(name, unit, f"settling {self.where} {unit}", 1e-3) for name, unit in names)

    def course_over(self, view: SetView) -> FloatArray:
        """As its course grows."""
        return self.course.grown(view.elapsed)

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """Displacement and turn in axes of the tracker, and the time constant where it does not grow steadily."""
        view, placement = self.seen_in(seen)
        found = self.in_tracker("displacement", x, std, placement)
        if np.isfinite(self.course.decay):
            span, unit = view.span
            found["time_constant"] = {
                "value": self.course.decay * span,
                "std": self.course.decay * self.course.spread * span,
                "unit": unit,
            }
        return found

    def pattern(self) -> str:
        """What it leaves."""
        return "the residual of all poses moves together from the start of the recording on, and ever more slowly"
