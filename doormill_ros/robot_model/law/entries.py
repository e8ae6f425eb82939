"""Terms of the entries of a kind's dictionary: for each place, driver and shape with its numbers in data's units."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from doormill_ros.robot_model.candidate import Case
from doormill_ros.robot_model.law.parts import number_of
from doormill_ros.robot_model.law.shapes import SHAPES
from doormill_ros.robot_model.law.term import Term, seen_in

#: Shapes with their rough numbers, in parts of how a driver was spread in the test.
Shapes = Sequence[tuple[str, float]]
#: What may drive something ("k" stands for every other joint), by which shapes, and whether also by a curve.
Drives = Sequence[tuple[str, Shapes, bool]]
#: What it acts on, its places, what may drive it.
Entry = tuple[str, Sequence[str], Drives]

#: Places of what is worn or tight, over the range that an angle had.
SECTORS: Shapes = tuple(("sector", float(part)) for part in np.round(np.arange(0.1, 0.95, 0.1), 1))

T = TypeVar("T", bound=Term)  # type: ignore[type-arg]


def terms(kind: type[T], case: Case, entries: Iterable[Entry], joints: Sequence[int]) -> list[T]:
    """Every term that data can speak of: its driver was recorded and changed.

    Args:
        kind: Of the terms.
        case: The data.
        entries: Of the dictionary.
        joints: Numbers of the joints that "k" may stand for.
    """
    found: list[T] = []
    for acts_on, places, drives in entries:
        for where in places:
            for driver, shapes, curve in drives:
                for name in _spelt(driver, number_of(where) + 1, joints):
                    found += _terms(kind, case, where, acts_on, name, shapes, curve)
    return list({term.identity: term for term in found}.values())


def _spelt(driver: str, own: int, joints: Sequence[int]) -> list[str]:
    """A driver, or one for every joint but the own."""
    if "joint k" not in driver:
        return [driver]
    return [driver.replace("joint k", f"joint {k}") for k in joints if k != own]


def _terms(
    kind: type[T], case: Case, where: str, acts_on: str, driver: str, shapes: Shapes, curve: bool
) -> Iterator[T]:
    values = kind.values_of(case, where, driver)
    values = values[np.isfinite(values)]
    if not len(values):
        return
    numbers = [(shape, SHAPES[shape].numbers(part, values)) for shape, part in shapes]
    knots = SHAPES["curve"].numbers(1.0, values)
    if curve and np.diff(knots).min() > 0.02 * np.ptp(values):
        numbers.append(("curve", knots))
    for shape, own in numbers:
        seen = seen_in(values, shape, own)
        if seen is not None:
            yield kind(where, acts_on, driver, shape, own, seen)
