"""How uncertain waves along an edge leave a line, whose length only the line's own residuals tell.

Waves about as long as what shows of an edge look like another line, and what is left then is too small to tell how
large they are. The edge is taken for a Gaussian process with a Matern covariance of smoothness 3/2, its variance and
length by restricted maximum likelihood (Patterson and Thompson, Biometrika 58, 1971), averaged over lengths as they are
likely.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray

_LENGTHS = np.geomspace(1.5e-3, 40.0e-3, 12)  # of waves, all as likely before an edge was seen [m]
_ALONE = (0.003, 0.1)  # variance that neighbouring pieces do not share, as shares of the waves'


@dataclass(frozen=True, eq=False)
class _Waves:
    """Waves of several lengths, and a line through pieces of an edge along which they run.

    Attributes:
        left: Quadratic forms of the residuals that estimate their variance, shape (k, n, n).
        plausible: Log likelihood but for the variance, shape (k,).
        place: Variance of the line's place per variance of the waves, shape (k,).
        slope: Of its slope likewise, shape (k,) [1/m^2].
    """

    left: FloatArray
    plausible: FloatArray
    place: FloatArray
    slope: FloatArray


@lru_cache(maxsize=64)
def _waves(used: bytes, piece: float) -> _Waves:
    """For the pieces of an edge that are used, as the bytes of a mask, each so long [m]."""
    at = piece * np.flatnonzero(np.frombuffer(used, dtype=bool))
    apart = np.abs(at[:, None] - at)
    line = np.column_stack([np.ones(at.size), at - at.mean()])
    fitted = np.linalg.pinv(line)
    each = []
    for length in _LENGTHS:
        scaled = np.sqrt(3.0) * apart / length
        waves = (1.0 + scaled) * np.exp(-scaled)
        for alone in _ALONE:
            together = waves + alone * np.eye(at.size)
            inverse = np.linalg.inv(together)
            known = line.T @ inverse @ line
            left = inverse - inverse @ line @ np.linalg.solve(known, line.T @ inverse)
            plausible = -0.5 * (np.linalg.slogdet(together)[1] + np.linalg.slogdet(known)[1])
            each.append((left, plausible, *np.diag(fitted @ together @ fitted.T)))
    return _Waves(*(np.array(part) for part in zip(*each, strict=True)))


def line_variances(residual: FloatArray, used: BoolArray, piece: float) -> tuple[float, float]:
    """Variances of the place [m^2] and of the slope of a line through pieces of an edge.

    Args:
        residual: Mean distance of each piece that is used from the line, shape (m,), five at least [m].
        used: Which pieces are, in their order along the edge, shape (n,), bool, m of them true.
        piece: Length of each [m].
    """
    waves, freedom = _waves(used.tobytes(), piece), residual.size - 2
    variance = np.einsum("i,kij,j->k", residual, waves.left, residual) / freedom
    likely = waves.plausible - 0.5 * freedom * np.log(np.maximum(variance, 1e-30))
    chance = np.exp(likely - likely.max())
    # A variance learned from few pieces may be a smaller one that happened to look so: Student's distribution.
    share = chance / chance.sum() * variance * freedom / (freedom - 2)
    return float(share @ waves.place), float(share @ waves.slope)
