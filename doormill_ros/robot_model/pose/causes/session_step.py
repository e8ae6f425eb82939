"""A cell that jumped once while a series was recorded: somebody leant on the tracker, the robot was bolted anew."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.causes.cause import Coefficient, PoseCause, Reported
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.causes.moved_base import MovedBase
from doormill_ros.robot_model.pose.chain import Placement
from doormill_ros.robot_model.pose.view import SetView

MARGIN = 20  #: rows at either end in which no step is looked for


class SessionStep(MovedBase):
    """Displacement of the robot's base from one row of a series on."""

    name = "session_step"

    def __init__(self, where: str, row: int, spread: int = 1) -> None:
        """Put it on a series ('set NAME'), at the first row after the step, which is known to so many rows."""
        super().__init__(where)
        self.row, self.spread = row, spread

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """On every series in which one is suspected."""
        return [cls(f"set {hints.sets[index].name}", *step) for index, step in hints.steps.items()]

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """The step: three displacements, three turns."""
        names = [("step_x", "m"), ("step_y", "m"), ("step_z", "m")]
        names += [("turn_x", "rad"), ("turn_y", "rad"), ("turn_z", "rad")]
        return tuple(
            Coefficient(name, unit, f"step {self.where} {self.row} {unit}", 1e-3) for name, unit in names
        )

    def course_over(self, view: SetView) -> FloatArray:
        """Nothing before its row, all of it from there on."""
        return (view.row >= self.row).astype(float)

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """Step and turn in axes of the tracker, the row from which on they act, and its time where that is known."""
        view, placement = self.seen_in(seen)
        steps = self.in_tracker("step", x, std, placement)
        steps["row"] = {"value": self.row, "std": float(self.spread), "unit": "-"}
        at = int(np.searchsorted(view.row, self.row))
        if view.time is not None and np.isfinite(view.time[at]):
            near = view.time[max(at - self.spread, 0) : at + self.spread]
            before = float(np.nanmax(view.time[at] - near))
            steps["time"] = {"value": float(view.time[at]), "std": before, "unit": "s"}
        return steps

    def pattern(self) -> str:
        """What it leaves."""
        return f"from row {self.row} on the residual of all poses has jumped together"


def find_step(error: FloatArray, scale: FloatArray, weight: FloatArray) -> tuple[int, float]:
    """Where a constant shift of the base explains most, and by how much.

    Args:
        error: Residuals in the axes of the base, shape (n, 6).
        scale: One over their standard deviations, shape (6,).
        weight: Of the rows, shape (n,).

    Returns:
        Index of the first row after the step, and the fall of the sum of squares.
    """
    n = len(error)
    if n < 2 * MARGIN + 2:
        return 0, 0.0
    y = error[:, :3] * scale[:3]
    w = weight[:, None]
    before, total = np.cumsum(w * y, axis=0), np.sum(w * y, axis=0)
    count, everything = np.cumsum(w, axis=0), np.sum(w)
    mean = before / np.maximum(count, 1e-9)
    rest = (total - before) / np.maximum(everything - count, 1e-9)
    fall = np.sum((mean - rest) ** 2, axis=1) * (count * (everything - count) / everything)[:, 0]
    inside = slice(MARGIN - 1, n - MARGIN - 1)
    best = int(np.argmax(fall[inside])) + MARGIN - 1
    return best + 1, float(fall[best])
