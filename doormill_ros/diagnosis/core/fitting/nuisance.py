"""What nobody asks about but what moves the rows: nuisance parameters, of known variance or of none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray

_SEEN = 1e-6  #: share of the best seen direction below which the rows see another one not at all


@dataclass(frozen=True, eq=False)
class Alike:
    """Rows that have one number in common, each row in one group.

    Attributes:
        group: Number of the group of each row, counted from 0, shape (n,).
        effect: Whitened effect of a number of unit variance on each row, shape (n,).
    """

    group: IntArray
    effect: FloatArray

    def take(self, rows: FloatArray) -> FloatArray:
        """Rows, shape (n, p), less what the numbers can make: the root of the inverse of their covariance."""
        squares = np.bincount(self.group, self.effect**2)
        share = (1.0 - 1.0 / np.sqrt(1.0 + squares)) / np.maximum(squares, np.finfo(float).tiny)
        seen = np.column_stack([np.bincount(self.group, self.effect * column) for column in rows.T])
        made: FloatArray = self.effect[:, None] * (share[:, None] * seen)[self.group]
        return rows - made

    @property
    def log_determinant(self) -> float:
        """Of the covariance of the rows."""
        return float(np.sum(np.log1p(np.bincount(self.group, self.effect**2))))


class Nuisance:
    """Takes from whitened rows what nuisance parameters can make, as far as these are not known.

    It is a root of the inverse of the covariance of all rows: identity plus that of the parameters.

    Attributes:
        log_determinant: Of that covariance, parameters that may be anything left out.
    """

    def __init__(self, columns: FloatArray, free: FloatArray, alike: Alike | None = None) -> None:
        """Work out directions and shares.

        Args:
            columns: Of parameters of known variance: whitened effects of one of unit variance each, shape (n, k).
            free: Of parameters that may be anything, whitened, shape (n, m).
            alike: Parameters of known variance, of which each row has one.
        """
        self._alike = alike
        columns, free = self._less_alike(columns), self._less_alike(free)
        unknown, seen, _ = np.linalg.svd(free, full_matrices=False)
        unknown = unknown[:, seen > _SEEN * max(float(seen.max(initial=0.0)), 1e-30)]
        known = columns - unknown @ (unknown.T @ columns)
        basis, size, _ = np.linalg.svd(known, full_matrices=False)
        self._basis = np.hstack([unknown, basis])
        self._share = np.concatenate([np.ones(unknown.shape[1]), 1.0 - 1.0 / np.sqrt(1.0 + size**2)])
        of_groups = 0.0 if alike is None else alike.log_determinant
        self.log_determinant = of_groups + float(np.sum(np.log1p(size**2)))

    def take(self, rows: FloatArray) -> FloatArray:
        """Whitened rows, shape (n, p), less what the parameters can make."""
        rows = self._less_alike(rows)
        return rows - self._basis @ (self._share[:, None] * (self._basis.T @ rows))

    def _less_alike(self, rows: FloatArray) -> FloatArray:
        return rows if self._alike is None or not rows.shape[1] else self._alike.take(rows)
