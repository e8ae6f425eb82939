"""How the size of an effect goes over the doors of a shift: always the same, from one door on another, or drifting.

Both together only where something wears while something else changes: a mill and the wood that it cuts, say.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Candidate, Case, CauseParameter

ALWAYS, BEGINS, CHANGES, DRIFTS, WEARS_AND_CHANGES = "", "begins", "changes", "drifts", "drifts and changes"
GROWS = "grows"  #: a drift from nothing: where the level before it is nobody's question


@dataclass(frozen=True)
class SizeCourse:
    """The size of an effect over time.

    Attributes:
        kind: ALWAYS, BEGINS (nothing before `at`), CHANGES (another size before `at`), DRIFTS (linearly), GROWS
            (linearly, from nothing) or WEARS_AND_CHANGES (1 + size grows by a share in proportion to time, and by
            another from `at` on).
        at: From when on [s since the epoch].
        begin, end: Of a drift [s since the epoch].
        words: For the variant of a cause: "from door_014".
    """

    kind: str = ALWAYS
    at: float = 0.0
    begin: float = 0.0
    end: float = 1.0
    words: str = ""

    def weights(self, time: FloatArray) -> FloatArray:
        """Of each of the course's sizes at times of shape (n,), shape (n, sizes); of shares to first order."""
        after, always = (time >= self.at).astype(float), np.ones(len(time))
        if self.kind == ALWAYS:
            return always[:, None]
        if self.kind == BEGINS:
            return after[:, None]
        if self.kind == CHANGES:
            return np.column_stack([1.0 - after, after])
        late = (time - self.begin) / (self.end - self.begin)
        if self.kind == GROWS:
            return late[:, None]
        if self.kind == DRIFTS:
            return np.column_stack([always, late])
        return np.column_stack([always, late, after])

    def size(self, theta: FloatArray, time: FloatArray) -> FloatArray:
        """Theta of the effect at times of shape (n,), shape (n, p).

        Args:
            theta: One for each of the course's sizes, shape (sizes, p).
            time: When [s since the epoch].
        """
        weights = self.weights(time)
        if self.kind != WEARS_AND_CHANGES:
            return weights @ theta
        factor: FloatArray = np.prod(1.0 + weights[:, :, None] * theta, axis=1)
        return factor - 1.0

    @property
    def drifts(self) -> bool:
        """Whether part of it is a drift."""
        return self.kind in (DRIFTS, GROWS, WEARS_AND_CHANGES)

    @property
    def steps(self) -> bool:
        """Whether there is another size from `at` on."""
        return self.kind in (BEGINS, CHANGES, WEARS_AND_CHANGES)

    @property
    def sizes(self) -> int:
        """How many there are."""
        return {ALWAYS: 1, BEGINS: 1, GROWS: 1, CHANGES: 2, DRIFTS: 2, WEARS_AND_CHANGES: 3}[self.kind]

    def told(self, theta: FloatArray) -> dict[str, FloatArray]:
        """Theta of the effect at doors of note, shape (p,) each, by the suffix of its name; the last doors first.

        Args:
            theta: One for each size, shape (sizes, p).
        """
        at = {"": self.end}
        if self.kind in (CHANGES, WEARS_AND_CHANGES):
            at["before"] = np.nextafter(self.at, -np.inf)
        if self.drifts:
            at["at_first"] = self.begin
        sizes = self.size(theta, np.array(list(at.values())))
        return dict(zip(at, sizes, strict=True))


class SizedEffect(Candidate[Case], Generic[Case]):
    """An effect of a size theta that a `SizeCourse` lets change.

    Attributes:
        drifts: Whether it has a course of its own that is a drift.
    """

    drifts = False

    def columns(self, case: Case) -> FloatArray:
        """What is measured for theta = 1, shape (n, p)."""
        raise NotImplementedError


F = TypeVar("F", bound=SizedEffect[Any])


class OverTime(Candidate[Any], Generic[F]):
    """An effect with a course; its numbers are those of the effect, once for each size of the course.

    Reported is what holds for the last doors; what held before or at first stands beside it.
    """

    def __init__(self, effect: F, course: SizeCourse | None = None) -> None:
        """Join the two."""
        super().__init__(effect.where)
        self.effect, self.course = effect, course or SizeCourse()
        self.name, self.of_robot, self.named = effect.name, effect.of_robot, effect.named
        self.generalises, self.check = effect.generalises, effect.check
        self.variant = ", ".join(word for word in (effect.variant, self.course.words) if word)
        self.series = f"{effect.series} {self.course.words}" if effect.series else ""
        times = self.course.sizes
        self.scale = np.tile(effect.scale, times)
        self.lower, self.upper = np.tile(effect.lower, times), np.tile(effect.upper, times)
        if self.course.kind == DRIFTS:  # the second size is a difference
            self.lower = np.concatenate([effect.lower, -effect.upper])
        self.parameters = tuple(
            CauseParameter("_".join(filter(None, (p.name, suffix))), p.unit, p.low, p.high, p.size)
            for suffix in self.course.told(np.zeros((times, effect.size)))
            for p in effect.parameters
        )

    def pattern(self) -> str:
        """What it leaves."""
        return self.effect.pattern()

    def spoils(self, other: Candidate[Any]) -> bool:
        """What the effect says of the other's."""
        return self.effect.spoils(other)

    def rows(self, theta: FloatArray, time: FloatArray) -> FloatArray:
        """The effect's theta for each row, shape (n, p)."""
        return self.course.size(theta.reshape(self.course.sizes, -1), time)

    def derivative(self, case: Any) -> FloatArray:
        """What each number does to the rows, shape (n, sizes p); `case.time` has their times, shape (n,) [s]."""
        weights, columns = self.course.weights(case.time), self.effect.columns(case)
        return (weights[:, :, None] * columns[:, None]).reshape(len(columns), -1)

    def values(self, theta: FloatArray, case: Any) -> FloatArray:
        """For the last doors, then before the step, then at first."""
        parts = self.course.told(theta.reshape(self.course.sizes, -1))
        return np.concatenate([self.effect.values(part, case) for part in parts.values()])
