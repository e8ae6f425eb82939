"""One term of a law without a name: what it acts on, times a shape of what drives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Candidate, Case, CauseParameter
from doormill_ros.robot_model.law.parts import Carrier, Drivers
from doormill_ros.robot_model.law.shapes import SHAPES, columns


@dataclass(frozen=True)
class SeenRange:
    """Where a driver was in the test that a law comes from.

    Attributes:
        low, high: Least and largest value.
        usual: Mean of the shape's columns, which stands where nobody knows the driver, shape (m,).
        ends: Whether the law is not believed beyond.
    """

    low: float
    high: float
    usual: tuple[float, ...]
    ends: bool = False


def seen_in(values: FloatArray, shape: str, numbers: tuple[float, ...]) -> SeenRange | None:
    """What a test has seen of a driver, values of shape (n,); None where it never changed (but for a level)."""
    values = values[np.isfinite(values)]
    if not len(values) or (not SHAPES[shape].constant and np.ptp(values) < 1e-9):
        return None
    usual = columns(shape, values, numbers).mean(axis=0)
    return SeenRange(float(values.min()), float(values.max()), tuple(map(float, usual)))


class Term(Candidate[Case]):
    """A term whose weights are fitted; theta is in typical amplitudes of what it acts on.

    Attributes:
        acts_on: A carrier.
        driver: What drives it.
        shape: How it follows that.
        numbers: The shape's own.
        seen: Where the driver was in the test.
        carriers: Of the kind, by their names.
        drivers: Of the kind.
        carrier: What `acts_on` does.
        drives: What `driver` is.
        follows: What `shape` is.
    """

    named = False
    carriers: ClassVar[Mapping[str, Carrier[Any]]]
    drivers: ClassVar[Drivers[Any]]

    def __init__(
        self, where: str, acts_on: str, driver: str, shape: str, numbers: tuple[float, ...], seen: SeenRange
    ) -> None:
        """Put the term together.

        Raises:
            KeyError: No such carrier, driver or shape.
        """
        super().__init__(where)
        self.acts_on, self.driver, self.shape, self.numbers, self.seen = acts_on, driver, shape, numbers, seen
        self.carrier, self.drives = self.carriers[acts_on], self.drivers.driver(driver)
        self.follows = SHAPES[shape]
        self.of_robot = self.carrier.of_robot
        self.name = f"{acts_on} by {driver}: {shape}"
        self.variant = ", ".join(f"{value:.4g}" for value in numbers)
        reach = 0.0 if seen.ends else self._reach()
        self._known = seen.low - reach, seen.high + reach
        self._wide = len(seen.usual)
        count = self._wide * self.carrier.components
        self.scale, self.lower, self.upper = np.ones(count), np.full(count, -1e6), np.full(count, 1e6)
        self.parameters = (CauseParameter("weights", self.carrier.unit, -np.inf, np.inf, count),)

    def _reach(self) -> float:
        """How far the law goes on beyond what was seen where it stands alone."""
        width = self.seen.high - self.seen.low
        return np.inf if width >= 0.5 * self.follows.period(self.numbers) else self.follows.reach * width

    @property
    def repeats(self) -> bool:
        """Whether a whole period of it was seen."""
        return self.seen.high - self.seen.low >= self.follows.period(self.numbers)

    def ended(self) -> Self:
        """The same, not believed beyond what was seen."""
        seen = replace(self.seen, ends=True)
        return type(self)(self.where, self.acts_on, self.driver, self.shape, self.numbers, seen)

    @classmethod
    def values_of(cls, case: Case, where: str, driver: str) -> FloatArray:
        """Value of a driver in every row for an effect at a place, shape (n,), NaN where nobody knows."""
        raise NotImplementedError

    def followed(self, case: Case) -> FloatArray:
        """Columns of the shape in each row, shape (n, m)."""
        values = self.values_of(case, self.where, self.driver)
        unknown = ~np.isfinite(values)
        values = np.clip(values, *self._known)
        middle = 0.5 * (self.seen.low + self.seen.high)
        result = columns(self.shape, np.where(unknown, middle, values), self.numbers)
        result[unknown] = self.seen.usual
        return result

    def values(self, theta: FloatArray, case: Case) -> FloatArray:
        """Weights, SI, those of the first component first, shape (p,)."""
        return self.carrier.size * np.asarray(theta)

    def from_values(self, values: FloatArray, case: Case) -> FloatArray:
        """From the weights, shape (p,)."""
        return np.asarray(values) / self.carrier.size

    def neighbours(self, case: Case) -> list[Self]:
        """The same term with own numbers a little smaller and larger, where these were a rough choice."""
        values, found = self.values_of(case, self.where, self.driver), []
        for numbers in self.follows.refined(self.numbers):
            seen = seen_in(values, self.shape, numbers)
            if seen is not None:
                found.append(type(self)(self.where, self.acts_on, self.driver, self.shape, numbers, seen))
        return found

    def pattern(self) -> str:
        """What it is."""
        return f"{self.name} at {self.where}"

    def told(self, weights: FloatArray) -> str:
        """The law of some weights, SI, shape (p,), in one line with numbers and units."""
        share = self.carrier.unit == "1"
        unit = "%" if share else self.carrier.unit
        rows = np.atleast_2d((100.0 if share else 1.0) * np.asarray(weights)).reshape(-1, self._wide)
        texts = [f"{value:+.3g} {unit}" for value in rows[0]]
        if len(rows) > 1:
            texts = [f"({', '.join(f'{value:+.3g}' for value in column)}) {unit}" for column in rows.T]
        law = self.follows.told(self.driver, self.drives.unit, self.numbers, texts)
        return f"{self.where} {self.carrier.does}: {law}"

    def document(self, weights: FloatArray) -> dict[str, Any]:
        """The term as model.yaml has it, with weights, SI, shape (p,)."""
        return {
            "where": self.where,
            "acts_on": self.acts_on,
            "driver": self.driver,
            "shape": self.shape,
            "numbers": [float(value) for value in self.numbers],
            "seen": {**vars(self.seen), "usual": list(self.seen.usual)},
            "weights": {"value": [float(value) for value in weights], "unit": self.carrier.unit},
            "known_on_path": self.drives.of_path,
            "law": self.told(weights),
        }

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> tuple[Self, FloatArray]:
        """A term and its weights of what `document` gave.

        Raises:
            KeyError, TypeError, ValueError: It is not that.
        """
        seen = document["seen"]
        usual = tuple(float(value) for value in seen["usual"])
        term = cls(
            str(document["where"]),
            str(document["acts_on"]),
            str(document["driver"]),
            str(document["shape"]),
            tuple(float(value) for value in document["numbers"]),
            SeenRange(float(seen["low"]), float(seen["high"]), usual, bool(seen.get("ends", False))),
        )
        weights = np.asarray(document["weights"]["value"], dtype=float)
        if weights.shape != (term.size,) or not np.all(np.isfinite(weights)):
            raise ValueError(f"{term.name} at {term.where} needs {term.size} finite weights of a known shape")
        return term, weights
