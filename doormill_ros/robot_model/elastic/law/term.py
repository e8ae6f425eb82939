"""One term of a law without a name: what it acts on, times a shape of what drives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import LinearTwist
from doormill_ros.robot_model.elastic.law.carriers import CARRIERS, number_of
from doormill_ros.robot_model.elastic.law.drivers import driver, reading
from doormill_ros.robot_model.elastic.law.shapes import REFINED, SHAPES, columns
from doormill_ros.robot_model.elastic.load_case import LoadCase

#: By which an own number is refined.
_STEPS = (0.6, 0.85, 1.18, 1.7)


@dataclass(frozen=True)
class Seen:
    """Where a driver was in the test that a law comes from.

    Attributes:
        low, high: Least and largest value.
        usual: Mean of the shape's columns, which stands where nobody knows the driver, shape (m,).
    """

    low: float
    high: float
    usual: tuple[float, ...]


def seen_in(case: LoadCase, where: str, name: str, shape: str, numbers: tuple[float, ...]) -> Seen | None:
    """What a test has seen of a driver; None where that was not recorded or never changed (but a constant)."""
    values = reading(name, case, number_of(where))
    values = values[np.isfinite(values)]
    if not len(values) or (name != "constant" and np.ptp(values) < 1e-9):
        return None
    usual = columns(shape, values, numbers).mean(axis=0)
    return Seen(float(values.min()), float(values.max()), tuple(map(float, usual)))


class LawTerm(LinearTwist):
    """A term whose weights are fitted; theta is in typical amplitudes of what it acts on.

    Attributes:
        acts_on: A carrier.
        driver: What drives it.
        shape: How it follows that.
        numbers: The shape's own.
        seen: Where the driver was in the test.
    """

    named = False

    def __init__(
        self, where: str, acts_on: str, driver: str, shape: str, numbers: tuple[float, ...], seen: Seen
    ) -> None:
        """Put the term together.

        Raises:
            KeyError: No such carrier or shape.
        """
        super().__init__(where)
        self.acts_on, self.driver, self.shape, self.numbers, self.seen = acts_on, driver, shape, numbers, seen
        self.carrier = CARRIERS[acts_on]
        self.of_robot = self.carrier.of_robot
        self.name = f"{acts_on} by {driver}: {shape}"
        self.variant = ", ".join(f"{value:.4g}" for value in numbers)
        self._wide = len(seen.usual)
        count = self._wide * self.carrier.components
        self.scale, self.lower, self.upper = np.ones(count), np.full(count, -1e6), np.full(count, 1e6)
        self.parameters = (CauseParameter("weights", self.carrier.unit, -np.inf, np.inf, count),)

    def followed(self, case: LoadCase) -> FloatArray:
        """Columns of the shape in each loading, shape (n, m)."""
        values = reading(self.driver, case, number_of(self.where))
        unknown = ~np.isfinite(values)
        if SHAPES[self.shape].bounded:
            values = np.clip(values, self.seen.low, self.seen.high)
        result = columns(
            self.shape, np.where(unknown, 0.5 * (self.seen.low + self.seen.high), values), self.numbers
        )
        result[unknown] = self.seen.usual
        return result

    def unit(self, case: LoadCase) -> FloatArray:
        """Every component of the carrier times every column of the shape."""
        key = ("law", self.where, self.acts_on)
        if key not in case.cache:
            case.cache[key] = np.stack(self.carrier.motion(case, self.where), axis=2)
        shape = self.followed(case)
        motion = self.carrier.size * case.cache[key]
        return (motion[:, :, :, None] * shape[:, None, None, :]).reshape(len(case), 6, -1)

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Weights, SI, those of the first component first, shape (p,)."""
        return self.carrier.size * np.asarray(theta)

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the weights."""
        return np.asarray(values) / self.carrier.size

    def neighbours(self, case: LoadCase) -> list[LawTerm]:
        """The same term with its first own number a little smaller and larger, where that was a rough choice."""
        if self.shape not in REFINED:
            return []
        found = []
        for factor in _STEPS:
            numbers = (factor * self.numbers[0], *self.numbers[1:])
            seen = seen_in(case, self.where, self.driver, self.shape, numbers)
            if seen is not None:
                found.append(LawTerm(self.where, self.acts_on, self.driver, self.shape, numbers, seen))
        return found

    def unknown(self, case: LoadCase) -> bool:
        """Whether nobody knows the driver in some of these loadings."""
        return not bool(np.isfinite(reading(self.driver, case, number_of(self.where))).all())

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
        law = SHAPES[self.shape].told(self.driver, driver(self.driver).unit, self.numbers, texts)
        return f"{self.where} {self.carrier.does}: {law}"

    def document(self, weights: FloatArray) -> dict[str, Any]:
        """The term as model.yaml has it, with weights, SI, shape (p,)."""
        return {
            "where": self.where,
            "acts_on": self.acts_on,
            "driver": self.driver,
            "shape": self.shape,
            "numbers": [float(value) for value in self.numbers],
            "seen": {"low": self.seen.low, "high": self.seen.high, "usual": list(self.seen.usual)},
            "weights": {"value": [float(value) for value in weights], "unit": self.carrier.unit},
            "law": self.told(weights),
        }


def term_of(document: Mapping[str, Any]) -> tuple[LawTerm, FloatArray]:
    """A term and its weights of what `LawTerm.document` gave.

    Raises:
        KeyError, TypeError, ValueError: It is not that.
    """
    seen = document["seen"]
    usual = tuple(float(value) for value in seen["usual"])
    term = LawTerm(
        str(document["where"]),
        str(document["acts_on"]),
        str(document["driver"]),
        str(document["shape"]),
        tuple(float(value) for value in document["numbers"]),
        Seen(float(seen["low"]), float(seen["high"]), usual),
    )
    driver(term.driver)
    weights = np.asarray(document["weights"]["value"], dtype=float)
    if term.shape not in SHAPES or weights.shape != (term.size,) or not np.all(np.isfinite(weights)):
        raise ValueError(f"{term.name} at {term.where} needs {term.size} finite weights of a known shape")
    return term, weights
