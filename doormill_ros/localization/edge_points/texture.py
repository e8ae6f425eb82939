"""What wood grain beside an edge does to the edge's place, and the weights that suffer least.

Streaks along an edge do not average out over its length. Their statistics are read off the
strips beside the edge as variograms, gamma(lag) = E[(v(x + lag) - v(x))^2] / 2, those of streaks
from pairs of rows far apart. The weights are the generalised least squares ones for a step in that
texture; laid over the face beside the edge they show how far the edge may have been pushed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import pi, sqrt

import numpy as np
from scipy.special import ndtr

from doormill_ros.arrays import Float32Array, FloatArray, IntArray
from doormill_ros.statistics import NORMAL_STD, median

PHASES = 4  # sub-pixel phases for which weights are kept
PIXEL_VARIANCE = 1.0 / 12.0  # what the pixel's own width adds to the point spread [px^2]
_TRIM = 0.9  # share of the rows used, the calmest; the others hold dust and chips
_FLOOR = 0.1  # variance that rounding to grey levels makes
_ARM = 4  # px averaged on each side of a step looked for in the face
# Such a step counts from this many times the usual difference, this share of the edge's step, these levels.
_INNER_USUAL, _INNER_SHARE, _INNER_LEAST = 10.0, 0.05, 3.0
_DOUBT = 2.5  # streaks count from so many standard errors of what was learned of them
_AVERAGED = 30.0  # rows over which what is no streak averages out; more would trust single rows too little
_STIFFNESS = 0.003  # share of white noise assumed beside the texture; keeps the weights smooth
_LEAST_NOISE = 1.0e-3  # and its least variance [grey levels^2]


def step_design(place: FloatArray, blur: float) -> FloatArray:
    """Level, step and shift x step at distances `place` (..., w) [px] from the edge; (..., w, 3)."""
    sigma = sqrt(blur**2 + PIXEL_VARIANCE)
    scaled = place / sigma
    design = np.empty((*place.shape, 3))
    design[..., 0] = 1.0
    design[..., 1] = ndtr(scaled)
    design[..., 2] = np.exp(-0.5 * np.square(scaled)) * (-1.0 / (sqrt(2 * pi) * sigma))
    return design


@lru_cache(maxsize=32)
def phase_places(half: int) -> FloatArray:
    """Distances of a window's pixels from the edge [px], for each phase, (PHASES, 2 half + 1), read only."""
    places: FloatArray = (
        np.arange(-half, half + 1)[None] - ((np.arange(PHASES) + 0.5) / PHASES - 0.5)[:, None]
    )
    places.setflags(write=False)
    return places


@dataclass(frozen=True, eq=False)
class Variograms:
    """Texture of a surface beside an edge as variograms, gamma(0..lags) [grey levels^2].

    Attributes:
        rows: Of pixels in one row: all texture, and the noise.
        lasting: Of what rows far apart have in common: streaks along the edge.
    """

    rows: FloatArray
    lasting: FloatArray

    @property
    def plain(self) -> bool:
        """Whether streaks count for less than what averages out over rows."""
        return bool(self.lasting.max() < self.rows.max() / _AVERAGED)


def learn_variograms(strip: Float32Array, lags: int, apart: int, most: float) -> Variograms:
    """Learn the texture of n rows of m pixels; where lag >= m the last value is kept.

    Args:
        strip: Rows of pixels on one surface, a column each, shape (m, n).
        lags: Largest lag wanted [px].
        apart: Rows so many numbers apart have only streaks in common.
        most: Largest standard deviation believed to be texture [grey levels].
    """
    level = np.ascontiguousarray(strip.T)
    count, wide = level.shape
    level -= (level.sum(axis=1) * np.float32(1.0 / wide))[:, None]
    liveliness = np.einsum("nm,nm->n", level, level)
    keep = max(int(_TRIM * count), 1)
    ordered = liveliness.copy()
    ordered.partition(keep - 1)
    calm = liveliness <= ordered[keep - 1]
    level *= calm[:, None]
    rows = _variogram(level.T @ level / keep)
    rows[1:] += _FLOOR
    apart = min(apart, count // 2)
    pairs = max(int(np.count_nonzero(calm[apart:] & calm[: count - apart])), 1)
    cross = level[apart:].T @ level[: count - apart] / pairs
    # Noise alone seems to have streaks, about as large as what averages out: weights against them do harm.
    doubt = _DOUBT * rows / np.sqrt(pairs * np.arange(rows.size, 0, -1))
    lasting = np.maximum(_variogram(0.5 * (cross + cross.T)) - doubt, 0.0)
    last = np.minimum(np.arange(lags + 1), rows.size - 1)
    return Variograms(
        rows[last] * min(1.0, most**2 / rows.max()),
        lasting[last] * min(1.0, most**2 / (lasting.max() + 1e-9)),
    )


def _variogram(products: FloatArray) -> FloatArray:
    """E[(v_i - v_j)^2] / 2 by lag, of E[v_i v_j]."""
    power = products.diagonal()
    squares = power[:, None] + power - 2 * products
    lag, count = _lags(len(products))
    return 0.5 * np.bincount(lag, weights=squares.ravel()) / count


@lru_cache(maxsize=32)
def _lags(size: int) -> tuple[IntArray, IntArray]:
    """Lag of each pair of pixels (size^2,), and how many pairs each lag has."""
    lag = np.abs(np.arange(size)[:, None] - np.arange(size)).ravel()
    return lag, np.bincount(lag)


def covariance_function(gamma: FloatArray, fine: int = 1) -> FloatArray:
    """Covariance at lags 0, 1 / fine .. n whose variogram is nearest to gamma(0..n).

    Its spectrum is made non-negative, for a variogram learned from a few rows need not be one.
    Levels are fitted beside it, so that any constant may be added to it.

    Args:
        gamma: Variogram at lags 0..n, shape (n + 1,) [grey levels^2].
        fine: Values wanted per lag.

    Returns:
        Covariance, shape (n fine + 1,) [grey levels^2].
    """
    count = gamma.size - 1
    power = gamma.max() - gamma
    there, back = _cosines(count, fine)
    covariance: FloatArray = back @ np.maximum(there @ power, 0.0)
    return covariance


@lru_cache(maxsize=64)
def _cosines(count: int, fine: int) -> tuple[FloatArray, FloatArray]:
    """Fourier transform of an even function of lags 0..count, and its inverse to lags `1 / fine` apart.

    Shapes are (count + 1, count + 1) and (count fine + 1, count + 1); functions are so short that products with
    them cost less than a fast transform.
    """
    lag = np.arange(count + 1)
    twice = np.where((lag == 0) | (lag == count), 1.0, 2.0)
    there = np.cos(np.pi / count * np.outer(lag, lag)) * twice
    if fine > 1:
        twice[count] = 2.0  # the highest frequency is not the last of the finer function
    back = np.cos(np.pi / (count * fine) * np.outer(np.arange(count * fine + 1), lag)) * (twice / (2 * count))
    return there, back


def step_weights(half: int, blur: float, inside: Variograms, outside: Variograms) -> Float32Array:
    """Generalised least squares weights (PHASES, 3, w) of level, step and shift x step.

    Each side of the edge has its own texture, which ends there. Weights so one-sided would turn a
    point spread taken for too wide or too narrow into a shift; the fourth column of the design, the
    derivative with respect to its width, makes them blind for that. Streaks last along the edge while the
    rest averages out, so the rest counts by its share in _AVERAGED rows only.

    Args:
        half: Pixels on each side of a window's middle.
        blur: Standard deviation of the point spread [px].
        inside: Texture of the face, at least up to lag 2 half.
        outside: Texture of what lies behind it.
    """
    place = phase_places(half)
    sigma = sqrt(blur**2 + PIXEL_VARIANCE)
    design = np.empty((*place.shape, 4))
    design[..., :3] = step_design(place, blur)
    design[..., 3] = design[..., 2] * place / sigma
    lag = _lags(2 * half + 1)[0].reshape(2 * half + 1, -1)
    out = design[..., 1]
    covariance = np.zeros((PHASES, 2 * half + 1, 2 * half + 1))
    noise = 0.0
    for share, side in ((1.0 - out, inside), (out, outside)):
        function = covariance_function((side.lasting + side.rows / _AVERAGED)[: 2 * half + 1])
        covariance += share[:, :, None] * share[:, None, :] * function[lag]
        noise = max(noise, _STIFFNESS * function[0])
    covariance.reshape(PHASES, -1)[:, :: 2 * half + 2] += noise + _LEAST_NOISE
    weighted = np.linalg.solve(covariance, design)
    weights = np.linalg.solve(np.swapaxes(design, 1, 2) @ weighted, np.swapaxes(weighted, 1, 2))
    return weights[:, :3].astype(np.float32)


def streaks(common: Float32Array) -> float:
    """Standard deviation of what all rows of a strip have in common (m,), a slope aside [grey levels]."""
    place = np.arange(common.size) - (common.size - 1) / 2
    common = common - common.mean()
    left = common - place * ((place @ common) / (place @ place))
    return sqrt(left @ left / left.size)


def steps_beside(common: Float32Array, step: float) -> list[tuple[int, float]]:
    """Other steps in a surface beside an edge: distance from the strip's outer end [px], the furthest first, and size.

    Args:
        common: Median row of the surface, its end next to the edge, shape (m,).
        step: Step at the edge [grey levels].
    """
    sums = np.zeros(common.size + 1)
    np.cumsum(common, out=sums[1:])
    steps = (sums[2 * _ARM :] + sums[: -2 * _ARM] - 2 * sums[_ARM:-_ARM]) / _ARM
    size = np.abs(steps)
    least = max(_INNER_USUAL * NORMAL_STD * median(size), _INNER_SHARE * abs(step), _INNER_LEAST)
    found = []
    for at in np.flatnonzero(size >= least):
        if size[at] == size[max(at - 2 * _ARM, 0) : at + 2 * _ARM + 1].max():
            found.append((int(common.size - (at + _ARM)), float(steps[at])))
    return found


@dataclass(frozen=True)
class Push:
    """Variance of what texture adds to a line: its place [px^2] and its slope [px^2 per px^2]."""

    place: float
    slope: float


def push(strip: Float32Array, along: IntArray, weights: Float32Array, blur: float, step: float) -> Push:
    """How far texture like that in `strip` pushes a line fitted to edge points.

    Args:
        strip: Rows of pixels on one side of the edge, the side where windows begin, a column each, shape (m, n).
        along: Number of each row [px], shape (n,).
        weights: From `step_weights`.
        blur: Standard deviation of the point spread [px].
        step: Step at the edge [grey levels].
    """
    half = weights.shape[2] // 2
    place = phase_places(half)[PHASES // 2]
    kernel = weights[PHASES // 2, 2] * (1 - ndtr(place / sqrt(blur**2 + PIXEL_VARIANCE)))
    used = kernel[: half + int(np.ceil(2 * blur)) + 2]
    if len(strip) < used.size + 2:
        return Push(0.0, 0.0)
    count = (len(strip) - used.size) // 5 + 1
    windows = np.zeros((count, len(strip)))
    for k in range(count):
        windows[k, 5 * k : 5 * k + used.size] = used / step
    moved = windows @ strip  # (k, n), shift at each row for each place of the window
    limit = 4 * median(np.abs(moved)) + 1e-6
    moved = np.minimum(np.maximum(moved, -limit), limit)
    lever = along - along.mean()
    places = moved.sum(axis=1) / along.size
    slopes = moved @ lever / (lever @ lever)
    return Push(float(places @ places) / count, float(slopes @ slopes) / count)
