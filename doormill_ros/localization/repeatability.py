"""How far poses of one door that did not move lie apart, and whether their covariances allow for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from doormill_ros.arrays import FloatArray

UNLIKELY = 0.01  #: chance of a spread so large below which the stated covariance does not hold


@dataclass(frozen=True, eq=False)
class Repeatability:
    """Spread of repeated poses with k degrees of freedom each.

    Attributes:
        count: How many poses, n.
        mean: Their mean, weighted by their covariances, shape (k,).
        spread: Their standard deviations about the plain mean, shape (k,).
        stated: Root mean squares of the standard deviations stated, shape (k,).
        chi_square: Sum of squared distances from the weighted mean, each by its own covariance.
        freedom: Degrees of freedom of it, k (n - 1).
    """

    count: int
    mean: FloatArray
    spread: FloatArray
    stated: FloatArray
    chi_square: float
    freedom: int

    @property
    def probability(self) -> float:
        """Chance of a chi-square at least this large if the covariances are right."""
        return float(chdtrc(self.freedom, self.chi_square))

    @property
    def allowed(self) -> bool:
        """Whether the covariances allow for the spread.

        Only a spread too large speaks against them: what all poses share, such as the roughness of the same edge,
        is in the covariances and not in the spread.
        """
        return self.probability >= UNLIKELY


def repeatability(poses: FloatArray, covariances: FloatArray) -> Repeatability:
    """Compare the spread of poses with what was stated of them.

    With a weighted mean m the sum of (x_i - m)^T C_i^-1 (x_i - m) over n poses of k degrees of freedom has a
    chi-square distribution with k (n - 1) degrees of freedom when the errors are independent.

    Args:
        poses: One a row, shape (n, k), n from 2 up [m, rad].
        covariances: Of each by itself, shape (n, k, k).

    Raises:
        ValueError: Fewer than two poses, or shapes that do not belong together.
    """
    count, size = poses.shape
    if count < 2 or covariances.shape != (count, size, size):
        raise ValueError(
            f"{count} poses and covariances of shape {covariances.shape}, allowed are (n, k, k), n >= 2"
        )
    weights = np.linalg.inv(covariances)
    mean = np.linalg.solve(weights.sum(axis=0), np.einsum("nij,nj->i", weights, poses))
    off = poses - mean
    return Repeatability(
        count=count,
        mean=mean,
        spread=poses.std(axis=0, ddof=1),
        stated=np.sqrt(np.mean(np.diagonal(covariances, axis1=1, axis2=2), axis=0)),
        chi_square=float(np.einsum("ni,nij,nj->", off, weights, off)),
        freedom=size * (count - 1),
    )
