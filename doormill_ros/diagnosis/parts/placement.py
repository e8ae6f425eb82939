"""Doors of which nobody knows where they stood when they were measured: position and angle are fitted away."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Self

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.problem import Prediction
from doormill_ros.diagnosis.core.robust import trial_weights
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause

_ROUNDS = 10  #: of reweighting until gross errors steer no placement
_SEEN = 1e-6  #: share of the best seen direction below which the walls see a displacement not at all


def placement_columns(point: FloatArray, normal: FloatArray, door: IntArray) -> FloatArray:
    """What displacing and turning each door does along the normals of its walls.

    Args:
        point: Points on walls, shape (n, 3) [m].
        normal: Unit normals there, shape (n, 3).
        door: Number of the door of each point, -1 for one that was measured where it had stood, shape (n,).

    Returns:
        Orthonormal columns, shape (n, k), at most six a door: directions that its walls cannot see are left out.
    """
    found = [np.zeros((len(point), 0))]
    for number in np.unique(door[door >= 0]):
        rows = door == number
        arm = point[rows] - point[rows].mean(axis=0)
        size = max(float(np.linalg.norm(arm, axis=1).max()), 1e-9)
        columns = np.zeros((len(point), 6))
        columns[rows] = np.hstack([normal[rows], np.cross(arm, normal[rows]) / size])
        basis, seen, _ = np.linalg.svd(columns, full_matrices=False)
        found.append(basis[:, seen > _SEEN * seen[0]])
    return np.hstack(found)


class FreePartProblem(LoadingProblem):
    """A loading test along walls whose doors may have been displaced and turned by any amount.

    Residuals and derivatives are taken less their best fit by a placement of each door, so that nothing counts
    that a placement could make.
    """

    def __init__(
        self,
        data: Trials,
        finite: bool = False,
        sight: FloatArray | None = None,
        groups: IntArray | None = None,
        allowed: Callable[[ElasticCause], bool] = lambda cause: True,
        placement: FloatArray | None = None,
    ) -> None:
        """As `LoadingProblem`; `placement` are columns along the sight, shape (n, k), see `placement_columns`."""
        super().__init__(data, finite, sight, groups, allowed)
        self.placement = np.zeros((len(data), 0)) if placement is None else placement
        columns = self.placement * np.linalg.norm(self.whiten[:, 0], axis=1, keepdims=True)
        self._columns, self._fit = columns, np.linalg.pinv(columns)
        before = super().predict((), np.zeros(0)).white[:, 0]
        for _ in range(_ROUNDS):
            left = before - columns @ (self._fit @ before)
            root = np.sqrt(trial_weights(left**2, True, self.components))
            self._fit = np.linalg.pinv(columns * root[:, None]) * root

    def _free(self, rows: FloatArray) -> FloatArray:
        """Whitened rows less their placement, shape (n, 3) or (n, 3, p); the first of three components is the sight."""
        free = rows.copy()
        free[:, 0] -= self._columns @ (self._fit @ rows[:, 0])
        return free

    def predict(
        self, members: Sequence[ElasticCause], theta: FloatArray, derivative: bool = False
    ) -> Prediction:
        """Residuals, likelihood and derivatives of what no placement makes, as `Problem.predict`."""
        found = super().predict(members, theta, derivative)
        white = self._free(found.white)
        cost = found.cost + np.sum(white**2, axis=1) - np.sum(found.white**2, axis=1)
        jacobian = None if found.jacobian is None else self._free(found.jacobian)
        return Prediction(self.measured_part(white), white, cost, jacobian, found.spread)

    def slope(self, cause: ElasticCause, theta: FloatArray) -> FloatArray:
        """Whitened derivative by one cause alone, less what a placement makes, shape (n, 3, p)."""
        return self._free(super().slope(cause, theta))

    def bent(self) -> Self | None:
        """The same with finite joint angles, where these differ from first order by more than the noise."""
        if not self.curved:
            return None
        return type(self)(self.data, True, self.sight, self.configuration, self.allowed, self.placement)
