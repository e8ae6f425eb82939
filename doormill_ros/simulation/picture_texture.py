"""Seeded random fields: the wander of a sawn edge and the texture of surfaces."""

from __future__ import annotations

import cv2
import numpy as np

TILE = 1024  # side of a periodic texture tile [samples]


class Wander:
    """A stationary Gaussian process along a line, autocorrelation exp(-(s/correlation)^2)."""

    def __init__(
        self, rng: np.random.Generator, rms: float, correlation: float, start: float, stop: float
    ) -> None:
        """Draw one realisation between `start` and `stop` [m]; `rms`, `correlation` in [m]."""
        self._step = correlation / 20.0
        self._start = start - 4.0 * correlation
        count = int(np.ceil((stop - start + 8.0 * correlation) / self._step))
        # White noise through a Gaussian of width correlation/2 has that autocorrelation.
        offsets = np.arange(-60, 61) * self._step
        kernel = np.exp(-2.0 * (offsets / correlation) ** 2)
        white = rng.standard_normal(count + 120)
        self._values = np.convolve(white, kernel / np.sqrt(np.sum(kernel**2)), mode="valid") * rms

    def __call__(self, along: np.ndarray) -> np.ndarray:
        """Deviation [m] at positions `along` [m], any shape."""
        at = np.clip((along - self._start) / self._step, 0, len(self._values) - 1.001)
        index = at.astype(np.int32)
        share = at - index
        return self._values[index] * (1.0 - share) + self._values[index + 1] * share


def tile(rng: np.random.Generator, width_x: float, width_y: float) -> np.ndarray:
    """A periodic field of mean 0 and standard deviation 1, float32, shape (TILE, TILE).

    Args:
        rng: Source of randomness.
        width_x: Smoothing length along the columns' direction [samples].
        width_y: Smoothing length along the rows' direction [samples].
    """
    white = rng.standard_normal((TILE, TILE), dtype=np.float32)
    pad = int(min(TILE, 4 * max(width_x, width_y))) + 1
    wrapped = cv2.copyMakeBorder(white, pad, pad, pad, pad, cv2.BORDER_WRAP)
    smooth = cv2.GaussianBlur(wrapped, (0, 0), sigmaX=max(width_x, 0.3), sigmaY=max(width_y, 0.3))
    field = smooth[pad:-pad, pad:-pad]
    return np.ascontiguousarray((field - field.mean()) / field.std())


def look_up(field: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Values of a periodic tile at sample coordinates x, y (float32 arrays of equal shape)."""
    return cv2.remap(field, x % TILE, y % TILE, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
