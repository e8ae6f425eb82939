"""What wood grain beside an edge does to the edge's place, and the weights that suffer least.

Streaks along an edge do not average out over its length. Their statistics are read off the
strips beside the edge as variograms, gamma(lag) = E[(v(x + lag) - v(x))^2] / 2: the weights are
then the generalised least squares ones for a step in that texture, and the same weights laid
over the face beside the edge show how far the edge may have been pushed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtr

from doormill_ros.localization.robust import median

PHASES = 8  # sub-pixel phases for which weights are kept
PIXEL_VARIANCE = 1.0 / 12.0  # what the pixel's own width adds to the point spread [px^2]
_TRIM = 0.9  # share of the rows used, the calmest; the others hold dust and chips
_FLOOR = 0.1  # variance that rounding to grey levels makes
_ARM = 4  # px averaged on each side of a step looked for in the face
# Such a step counts from this many times the usual difference, this share of the edge's step, these levels.
_INNER_USUAL, _INNER_SHARE, _INNER_LEAST = 8.0, 0.15, 2.5
_STIFFNESS = 0.02  # share of white noise assumed beside the texture; keeps the weights smooth


def step_design(place: np.ndarray, blur: float) -> np.ndarray:
    """Level, step and shift x step at distances `place` (..., w) [px] from the edge; (..., w, 3)."""
    sigma = np.sqrt(blur**2 + PIXEL_VARIANCE)
    slope = np.exp(-0.5 * (place / sigma) ** 2) / (np.sqrt(2 * np.pi) * sigma)
    return np.stack([np.ones_like(place), ndtr(place / sigma), -slope], axis=-1)


def phase_places(half: int) -> np.ndarray:
    """Distances of a window's pixels from the edge [px], for each sub-pixel phase, (PHASES, 2 half + 1)."""
    return np.arange(-half, half + 1)[None] - ((np.arange(PHASES) + 0.5) / PHASES - 0.5)[:, None]


def variogram(strip: np.ndarray, lags: int) -> np.ndarray:
    """gamma(0..lags) of rows of pixels (n, m) on one surface; where lag >= m the last value is kept."""
    level = strip - strip.mean(axis=1, keepdims=True)
    liveliness = np.einsum("nm,nm->n", level, level)
    keep = max(int(_TRIM * len(strip)), 1)
    calm = level[np.argpartition(liveliness, keep - 1)[:keep]]
    products = calm.T @ calm / keep
    power = np.diag(products)
    squares = power[:, None] + power - 2 * products  # E[(v_i - v_j)^2]
    lag, count = _lags(strip.shape[1])
    out = 0.5 * np.bincount(lag, weights=squares.ravel()) / count
    out[1:] += _FLOOR
    return out[np.minimum(np.arange(lags + 1), out.size - 1)]


@lru_cache(maxsize=8)
def _lags(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Lag of each pair of pixels (size^2,), and how many pairs each lag has."""
    lag = np.abs(np.arange(size)[:, None] - np.arange(size)).ravel()
    return lag, np.bincount(lag)


def step_weights(half: int, blur: float, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """Generalised least squares weights (PHASES, 3, w) of level, step and shift x step.

    Both sides of the edge count alike, though often only one has texture: weights that lean to
    one side would turn every difference of the true point spread from the assumed one into a
    shift of the edge.

    Args:
        half: Pixels on each side of a window's middle.
        blur: Standard deviation of the point spread [px].
        inside: Variogram of the face up to lag 2 half.
        outside: Variogram of what lies behind it.
    """
    design = step_design(phase_places(half), blur)
    lag = np.abs(np.arange(2 * half + 1)[:, None] - np.arange(2 * half + 1))
    gamma = 0.5 * (inside + outside)
    # The levels of both sides are fitted, so any constant may be added to a covariance.
    covariance = gamma.max() - gamma[lag] + _STIFFNESS * gamma.max() * np.eye(2 * half + 1)
    weighted = np.linalg.solve(covariance, design)
    return np.linalg.solve(np.swapaxes(design, 1, 2) @ weighted, np.swapaxes(weighted, 1, 2)).astype(
        np.float32
    )


def streaks(common: np.ndarray) -> float:
    """Standard deviation of what all rows of a strip have in common (m,), a slope aside [grey levels]."""
    place = np.arange(common.size) - (common.size - 1) / 2
    common = common - common.mean()
    return float(np.std(common - place * (place @ common) / (place @ place)))


def step_inside(common: np.ndarray, step: float) -> int | None:
    """Another step in the face beside an edge, as its distance from the strip's outer end [px], or None.

    Then what was taken for the edge of the face is that of something behind it: a rebate's lip
    or the back of the door, which shows just beside the face.

    Args:
        common: Median row of the face, its end next to the edge, shape (m,).
        step: Step at the edge [grey levels].
    """
    sums = np.concatenate([[0.0], np.cumsum(common)])
    steps = (sums[2 * _ARM :] + sums[: -2 * _ARM] - 2 * sums[_ARM:-_ARM]) / _ARM
    usual = 1.4826 * median(np.abs(steps))
    at = int(np.argmax(np.abs(steps)))
    if abs(steps[at]) < max(_INNER_USUAL * usual, _INNER_SHARE * abs(step), _INNER_LEAST):
        return None
    return int(common.size - (at + _ARM))


@dataclass(frozen=True)
class Push:
    """Variance of what texture adds to a line: its place [px^2] and its slope [px^2 per px^2]."""

    place: float
    slope: float


def push(strip: np.ndarray, along: np.ndarray, weights: np.ndarray, blur: float, step: float) -> Push:
    """How far texture like that in `strip` pushes a line fitted to edge points.

    Args:
        strip: Rows of pixels on one side of the edge, the side where windows begin, shape (n, m).
        along: Number of each row [px], shape (n,).
        weights: From `step_weights`.
        blur: Standard deviation of the point spread [px].
        step: Step at the edge [grey levels].
    """
    half = weights.shape[2] // 2
    place = phase_places(half)[PHASES // 2]
    kernel = weights[PHASES // 2, 2] * (1 - ndtr(place / np.sqrt(blur**2 + PIXEL_VARIANCE)))
    used = kernel[: half + int(np.ceil(2 * blur)) + 2]
    if strip.shape[1] < used.size + 2:
        return Push(0.0, 0.0)
    windows = np.lib.stride_tricks.sliding_window_view(strip, used.size, axis=1)[:, ::5]
    moved = windows @ (used / step)  # (n, k), shift at each row for each place of the window
    limit = 4 * median(np.abs(moved)) + 1e-6
    moved = np.clip(moved, -limit, limit)
    lever = along - along.mean()
    places = moved.mean(axis=0)
    slopes = lever @ moved / (lever @ lever)
    return Push(float(np.mean(places**2)), float(np.mean(slopes**2)))
