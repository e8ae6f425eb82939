"""How uncertain a line along a wandering edge is.

An edge wanders: neighbouring points deviate together, so their scatter alone says too little.
The variance that counts is that of averages over pieces longer than the wander.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.lines.waves import line_variances

_PIECE = 6.0e-3  # length over which deviations are averaged [m]; a sawn edge wanders over 2 mm
# Of Gaussian wander over 2 mm, averages over 6 mm hold a fifth too little variance; the biweight and the
# search for chips take another quarter off the largest of them.
_PIECE_BIAS = 1.6
_LONGER = (2, 3, 4)  # lengths of longer pieces [_PIECE]
# Few pieces hold too little of waves about as long as they are. So 5 of 100 lines along 80 and 130 mm of Gaussian waves
# over 10 to 15 mm are further off than twice what they state (test_wander.py); longer waves look like another line, and
# are asked by themselves.
_WAVES = 2.0
_WAVY = 0.5  # deviations 4 mm apart that go together so much are waves
_USED = 0.2  # share of the largest weight from which a piece counts
_FEWEST = 8  # thirds of pieces that tell of waves
_LEAST_WAVES = 8.0e-6  # waves smaller than that are left to the other pieces [m]
_LEAST_LONG = 5.0e-6  # and such that look like another line are asked for their length from that on [m]


class EdgePieces:
    """An edge cut into pieces, as long as wander lasts and longer."""

    def __init__(self, along: FloatArray, weight: FloatArray) -> None:
        """By its points' place along it [m], shape (n,), and their weight in the line, shape (n,)."""
        self._along = along
        self._third = ((along - along.min()) * (3 / _PIECE)).astype(np.intp)
        self._weight, self._square = weight, np.square(weight)
        self._total = float(self._square.sum())
        self._squares = np.bincount(self._third, weights=self._square).astype(float)
        self._single = _Size(self._squares, 1)

    @property
    def freedom(self) -> float:
        """Degrees of freedom of `variance`."""
        # Pieces overlap by two thirds: half as many degrees of freedom more than those side by side have.
        return max(1.5 * self._single.pieces - 2.0, 1.0)

    @cached_property
    def _longer(self) -> list[_Size]:
        return [_Size(self._squares, longer) for longer in _LONGER]

    def variance(self, residual: FloatArray) -> float:
        """Variance that independent points would need to make a line as uncertain as it is [m^2].

        Args:
            residual: Distance of the points from the line [m], shape (n,).
        """
        return max(self.variances(residual))

    def variances(self, residual: FloatArray, waves: bool = True) -> tuple[float, float]:
        """The same by the line's place and by its slope [m^2].

        Args:
            residual: Distance of the points from the line [m], shape (n,).
            waves: Whether waves are asked for their own length, too.
        """
        weighted = self._weight * residual
        sums = np.bincount(self._third, weights=weighted).astype(float)
        white = float(weighted.dot(weighted)) / self._total
        wander = max(self._single.variance(sums), white)
        # Waves longer than a piece of edge leave more in longer pieces, of which there are few: only waves show in
        # deviations that last over several millimetres.
        lasting = _lasting(sums) > _WAVY
        if lasting and white > _LEAST_WAVES**2:
            wander = max(wander, *(_WAVES * one.variance(sums) for one in self._longer))
        if waves and lasting and white > _LEAST_LONG**2:
            place, slope = self._by_waves(sums)
            return max(wander, place), max(wander, slope)
        return wander, wander

    def _by_waves(self, sums: FloatArray) -> tuple[float, float]:
        """The variances by the waves themselves; `sums` (n,) of weighted residuals in thirds of a piece."""
        used = self._squares > _USED * self._squares.max()
        if used.sum() < _FEWEST:
            return 0.0, 0.0
        weights = np.bincount(self._third, weights=self._weight)
        place, slope = line_variances(sums[used] / weights[used], used, _PIECE / 3)
        total = float(self._weight.sum())
        lever = self._along - float(self._weight.dot(self._along)) / total
        weighted = self._weight * lever
        return (
            place * total**2 / self._total,
            slope * float(weighted.dot(lever)) ** 2 / float(weighted.dot(weighted)),
        )


def _lasting(sums: FloatArray) -> float:
    """Correlation of deviations two thirds of a piece apart."""
    return float(sums[2:] @ sums[:-2]) / max(float(sums @ sums), 1e-30) if sums.size > 4 else 0.0


class _Size:
    """Pieces of one length.

    Attributes:
        pieces: How many there are side by side.
    """

    def __init__(self, squares: FloatArray, longer: int) -> None:
        """By the sums (n,) of squared weights in thirds of a piece; their length is so many times `_PIECE`."""
        self._ones = np.ones(min(3 * longer, squares.size))
        squares = np.convolve(squares, self._ones, "valid")
        most, total = float(squares.max()), float(squares.sum())
        self._used = squares > _USED * most
        self.pieces = total / most / self._ones.size
        fitted = (self.pieces + 0.5) / max(self.pieces - 1.5, 1.0)  # the line went along with the pieces
        self._scale = _PIECE_BIAS * fitted / float(squares[self._used].sum())

    def variance(self, sums: FloatArray) -> float:
        """Of averages over the pieces (see `EdgePieces`), by the sums (n,) of weighted residuals in thirds of one."""
        averaged = np.convolve(sums, self._ones, "valid")[self._used]
        return self._scale * float(averaged.dot(averaged))
