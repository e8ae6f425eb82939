"""How uncertain a line along a wandering edge is.

An edge wanders: neighbouring points deviate together, so their scatter alone says too little.
The variance that counts is that of averages over pieces longer than the wander.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

_PIECE = 6.0e-3  # length over which deviations are averaged [m]; a sawn edge wanders over 2 mm
# Of Gaussian wander over 2 mm, averages over 6 mm hold a fifth too little variance; the biweight and the
# search for chips take another quarter off the largest of them.
_PIECE_BIAS = 1.6
_LONGER = (2, 3, 4)  # lengths of longer pieces [_PIECE]
_WAVES = 1.3  # few pieces hold too little of waves about as long as they are
_WAVY = 0.5  # deviations 4 mm apart that go together so much are waves
_LEAST_WAVES = 8.0e-6  # waves smaller than that are left to the other pieces [m]


def point_variance(along: FloatArray, residual: FloatArray, weight: FloatArray) -> tuple[float, float]:
    """Variance that independent points would need to make a line as uncertain as it is [m^2], and its freedom.

    Args:
        along: Place of the points along the edge [m], shape (n,).
        residual: Their distance from the line [m], shape (n,).
        weight: Their weight in it, shape (n,).
    """
    third = ((along - along.min()) * (3 / _PIECE)).astype(np.intp)
    sums, squares = (np.bincount(third, weights=of).astype(float) for of in (weight * residual, weight**2))
    wander, pieces = _wander(sums, squares, 1)
    white = float((weight**2 @ residual**2) / (weight**2).sum())
    # Waves longer than a piece of edge leave more in longer pieces, of which there are few: only waves show in
    # deviations that last over several millimetres.
    if white > _LEAST_WAVES**2 and _lasting(sums) > _WAVY:
        wander = max(wander, *(_WAVES * _wander(sums, squares, longer)[0] for longer in _LONGER))
    return float(max(wander, white)), float(max(1.5 * pieces - 2, 1.0))


def _lasting(sums: FloatArray) -> float:
    """Correlation of deviations two thirds of a piece apart."""
    return float(sums[2:] @ sums[:-2]) / max(float(sums @ sums), 1e-30) if sums.size > 4 else 0.0


def _wander(sums: FloatArray, squares: FloatArray, longer: int) -> tuple[float, float]:
    """Variance (see `_point_variance`) of averages over pieces so many times `_PIECE`, and how many pieces there are.

    Args:
        sums: Weighted residuals of thirds of a piece, shape (n,).
        squares: Squares of their weights, shape (n,).
        longer: Length of the pieces in `_PIECE`.
    """
    # Pieces overlap by two thirds: half as many degrees of freedom more than those side by side have.
    size = min(3 * longer, sums.size)
    sums, squares = np.convolve(sums, np.ones(size), "valid"), np.convolve(squares, np.ones(size), "valid")
    used = squares > 0.2 * squares.max()
    pieces = squares.sum() / squares.max() / size
    fitted = (pieces + 0.5) / max(pieces - 1.5, 1.0)  # the line went along with the pieces
    return float(_PIECE_BIAS * fitted * (sums[used] @ sums[used]) / squares[used].sum()), float(pieces)
