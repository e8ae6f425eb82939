"""How the size of an effect goes over the doors of a shift: always the same, from one door on another, or drifting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.parts.case import CutCase
from doormill_ros.diagnosis.parts.effects.effect import Effect
from doormill_ros.robot_model.candidate import Candidate, CauseParameter

ALWAYS, BEGINS, CHANGES, DRIFTS = "", "begins", "changes", "drifts"


@dataclass(frozen=True)
class SizeCourse:
    """The size of an effect over time.

    Attributes:
        kind: ALWAYS, BEGINS (nothing before `at`), CHANGES (another size before `at`) or DRIFTS (linearly).
        at: From when on [s since the epoch]; of a drift, its begin.
        end: Of a drift.
        words: For the variant of a cause: "from door_014".
    """

    kind: str = ALWAYS
    at: float = 0.0
    end: float = 1.0
    words: str = ""

    def weights(self, time: FloatArray) -> FloatArray:
        """Of each of the course's sizes at times of shape (n,), shape (n, 1) or (n, 2)."""
        after = (time >= self.at).astype(float)
        if self.kind == ALWAYS:
            return np.ones((len(time), 1))
        if self.kind == BEGINS:
            return after[:, None]
        if self.kind == CHANGES:
            return np.column_stack([1.0 - after, after])
        return np.column_stack([np.ones(len(time)), (time - self.at) / (self.end - self.at)])

    @property
    def sizes(self) -> int:
        """How many there are."""
        return 1 if self.kind in (ALWAYS, BEGINS) else 2


class InTime(Candidate[CutCase]):
    """An effect with a course; its numbers are those of the effect, once for each size of the course.

    Reported is what holds for the last doors; what held before or at first stands beside it.
    """

    def __init__(self, effect: Effect, course: SizeCourse | None = None) -> None:
        """Join the two."""
        super().__init__(effect.where)
        self.effect, self.course = effect, course or SizeCourse()
        self.name, self.of_robot, self.named = effect.name, effect.of_robot, effect.named
        self.generalises = effect.generalises
        self.variant = ", ".join(word for word in (effect.variant, self.course.words) if word)
        times = self.course.sizes
        self.scale = np.tile(effect.scale, times)
        self.lower, self.upper = np.tile(effect.lower, times), np.tile(effect.upper, times)
        if self.course.kind == DRIFTS:
            self.lower = np.concatenate([effect.lower, -effect.upper])
        self.parameters = effect.parameters
        if times == 2:
            suffix = "before" if self.course.kind == CHANGES else "at_first"
            self.parameters += tuple(
                CauseParameter(f"{p.name}_{suffix}", p.unit, p.low, p.high, p.size) for p in effect.parameters
            )

    def pattern(self) -> str:
        """What it leaves."""
        return self.effect.pattern()

    def spoils(self, other: Candidate[CutCase]) -> bool:
        """What the effect says of the other's."""
        return self.effect.spoils(other)

    def rows(self, theta: FloatArray, time: FloatArray) -> FloatArray:
        """The effect's theta for each point, shape (n, p)."""
        return self.course.weights(time) @ theta.reshape(self.course.sizes, -1)

    def derivative(self, case: CutCase) -> FloatArray:
        """What each number moves the points along their normals, shape (n, sizes p) [m]; not for forces."""
        weights, columns = self.course.weights(case.time), self.effect.columns(case)
        return (weights[:, :, None] * columns[:, None]).reshape(len(columns), -1)

    def values(self, theta: FloatArray, case: CutCase) -> FloatArray:
        """For the last doors, then before or at first."""
        parts = theta.reshape(self.course.sizes, -1)
        if self.course.kind == CHANGES:
            parts = parts[::-1]
        if self.course.kind == DRIFTS:
            parts = np.array([parts[0] + parts[1], parts[0]])
        return np.concatenate([self.effect.values(part, case) for part in parts])
