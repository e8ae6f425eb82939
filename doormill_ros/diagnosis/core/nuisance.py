"""What nobody asks about but what moves the rows: nuisance parameters, of known variance or of none."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

_SEEN = 1e-6  #: share of the best seen direction below which the rows see another one not at all


class Nuisance:
    """Takes from whitened rows what nuisance parameters can make, as far as these are not known.

    It is the root of the covariance of all rows: identity plus that of the parameters.
    """

    def __init__(self, columns: FloatArray, free: FloatArray) -> None:
        """Work out directions and shares.

        Args:
            columns: Of parameters of known variance: whitened effects of one of unit variance each, shape (n, k).
            free: Of parameters that may be anything, whitened, shape (n, m).
        """
        unknown, seen, _ = np.linalg.svd(free, full_matrices=False)
        unknown = unknown[:, seen > _SEEN * max(float(seen.max(initial=0.0)), 1e-30)]
        known = columns - unknown @ (unknown.T @ columns)
        basis, size, _ = np.linalg.svd(known, full_matrices=False)
        self._basis = np.hstack([unknown, basis])
        self._share = np.concatenate([np.ones(unknown.shape[1]), 1.0 - 1.0 / np.sqrt(1.0 + size**2)])

    def take(self, rows: FloatArray) -> FloatArray:
        """Whitened rows, shape (n, p), less what the parameters can make."""
        return rows - self._basis @ (self._share[:, None] * (self._basis.T @ rows))
