"""Circumstances that only number the postures: a curve over them is a table with an entry for each.

Where every posture was visited once, all that differs from posture to posture follows the clock. A shape that can bend
over time then fits whatever was not understood, and says nothing of another day. It is a law only if a good part of
what it does happens while the posture stays: within one visit, or as the posture was visited again at another time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np

from doormill_ros.arrays import IntArray
from doormill_ros.robot_model.candidate import Case
from doormill_ros.robot_model.law.term import Term

#: Of the variance of a shape over all rows, the share that has to lie within postures. Times of two visits each, at
#: random, have a half.
_WITHIN = 0.25

T = TypeVar("T", bound=Term)  # type: ignore[type-arg]


def numbers_postures(term: Term[Case], case: Case, configuration: IntArray) -> bool:
    """Whether a term bends over something that hardly changes within a posture and is no property of it.

    Args:
        term: Of a dictionary.
        case: The data.
        configuration: Posture of each row, shape (n,).
    """
    if term.drives.of_path or term.follows.stiff:
        return False
    columns = term.followed(case)
    each, counts = np.unique(configuration, return_inverse=True, return_counts=True)[1:]
    means = np.stack([np.bincount(each, weights=column) for column in columns.T], axis=1) / counts[:, None]
    within, whole = np.sum((columns - means[each]) ** 2), np.sum((columns - columns.mean(axis=0)) ** 2)
    return bool(within < _WITHIN * whole)


def without_labels(
    terms: Iterable[T], case: Case, configuration: IntArray
) -> tuple[list[T], tuple[str, ...]]:
    """Terms that may become a law, and the drivers that only number the postures.

    Args:
        terms: Of a dictionary.
        case: The data.
        configuration: Posture of each row, shape (n,).
    """
    listed = list(terms)
    labels = [numbers_postures(term, case, configuration) for term in listed]
    may = [term for term, label in zip(listed, labels, strict=True) if not label]
    drivers = dict.fromkeys(term.driver for term, label in zip(listed, labels, strict=True) if label)
    return may, tuple(drivers)


def not_tried(labels: Sequence[str]) -> str:
    """One sentence on drivers that only number the postures."""
    return (
        f"No law that bends over {' or '.join(labels)} was tried: the postures were not visited again at other times, "
        "so that would only number them. Repeat the first postures at the end."
    )
