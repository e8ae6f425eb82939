"""Some rows of a problem as a problem of its own, for a search that must not see the others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Generic

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.fitting.problem import C, Prediction, Problem, make_folds


class SomeRows(Generic[C]):
    """Some rows of another problem; attributes as of that.

    The case stays that of all rows: candidates take from it where drivers were, and nothing that was measured.
    """

    def __init__(self, whole: Problem[C], rows: BoolArray) -> None:
        """Keep rows, shape (n,), of a problem."""
        self._whole, self._rows = whole, np.flatnonzero(rows)
        self.components, self.noise_floor, self.unit = whole.components, whole.noise_floor, whole.unit
        self.configuration = whole.configuration[self._rows]
        self.folds = make_folds(self.configuration)

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def case(self) -> Any:
        """Of all rows."""
        return self._whole.case

    def predict(self, members: Sequence[C], theta: FloatArray, derivative: bool = False) -> Prediction:
        """As `Problem.predict`; theta of shape (p,)."""
        every, rows = self._whole.predict(members, theta, derivative), self._rows
        return Prediction(
            every.residual[rows],
            every.white[rows],
            every.cost[rows],
            None if every.jacobian is None else every.jacobian[rows],
            None if every.spread is None else (every.spread[0][rows], every.spread[1][rows]),
        )

    def slope(self, cause: C, theta: FloatArray) -> FloatArray:
        """As `Problem.slope`, shape (n, c, p), at theta, shape (p,)."""
        return self._whole.slope(cause, theta)[self._rows]

    def measured_part(self, white: FloatArray) -> FloatArray:
        """As `Problem.measured_part`, shape (n, c)."""
        every = np.zeros((len(self._whole), white.shape[1]))
        every[self._rows] = white
        return self._whole.measured_part(every)[self._rows]
