"""Degrees and millimetres where radians and metres are wanted: numbers that no robot comes to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.trial_table import TrialTable


@dataclass(frozen=True)
class SiUnit:
    """A unit that some numbers should have, and how to tell that they have another.

    Attributes:
        largest: That is believed, in the unit.
        unit: SI.
        mistaken: What they are where they are larger, and what to do.
    """

    largest: float
    unit: str
    mistaken: str

    def problem(self, value: float) -> str:
        """What is wrong with a number that is too large."""
        return f"is {value:g}, allowed is up to {self.largest:g} {self.unit}: {self.mistaken}"


_DEGREES = "are these degrees? write radians"
_MILLIMETRES = "are these millimetres? write metres"
#: Of a joint: endless ones are recorded over some turns.
JOINT_ANGLE = SiUnit(50.0, "rad", _DEGREES)
#: Of one link to the next.
TWIST = SiUnit(10.0, "rad", _DEGREES)
#: Of a link, or from it to a reflector or tool.
LENGTH = SiUnit(20.0, "m", _MILLIMETRES)
#: From the tracker to its target: none sees farther.
DISTANCE = SiUnit(200.0, "m", _MILLIMETRES)
#: Of a reflector when a load is put on, in the middle of all: single ones may have been knocked off.
DISPLACEMENT = SiUnit(0.05, "m", _MILLIMETRES)


def check_cells(
    table: TrialTable, columns: Sequence[str], values: FloatArray, what: SiUnit, middle: bool = False
) -> None:
    """Refuse columns that are in another unit.

    Args:
        table: Where they were read.
        columns: Their names.
        values: What they hold, shape (n, len(columns)).
        what: They stand for.
        middle: Judge the median of each row's largest instead of every cell.

    Raises:
        TrialTableError: They are.
    """
    size = np.abs(values)
    if middle and float(np.median(size.max(axis=1))) <= what.largest:
        return
    for row, column in np.argwhere(size > what.largest):
        raise table.fail(int(row), columns[column], what.problem(values[row, column]))


def check_values(document: SetDocument, keys: tuple[str, ...], values: ArrayLike, what: SiUnit) -> None:
    """Refuse values of set.yaml that are in another unit.

    Raises:
        SetDescriptionError: They are.
    """
    flat = np.asarray(values, dtype=float).ravel()
    for value in flat[np.abs(flat) > what.largest]:
        raise document.fail(keys, what.problem(value))
