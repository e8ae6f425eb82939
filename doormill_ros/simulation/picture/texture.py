"""Textures of surfaces, taken from a bank of seeded random tiles."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from doormill_ros.arrays import Float32Array

TILE = 1024  # side of a periodic tile [samples]
PER_LENGTH = 4.0  # samples per correlation length
_BANK = 6  # tiles kept; a picture takes a random part of one, turned at random


@lru_cache(maxsize=_BANK)
def _tile(number: int) -> Float32Array:
    """A periodic Gaussian field of mean 0, standard deviation 1, correlation length PER_LENGTH; (TILE, TILE)."""
    white = np.random.default_rng((7331, number)).standard_normal((TILE, TILE), dtype=np.float32)
    pad = int(6 * PER_LENGTH)
    smooth = cv2.GaussianBlur(cv2.copyMakeBorder(white, *[pad] * 4, cv2.BORDER_WRAP), (0, 0), PER_LENGTH / 2)
    part = smooth[pad:-pad, pad:-pad]
    out = np.ascontiguousarray((part - part.mean()) / part.std())
    out.setflags(write=False)
    return out


class Texture:
    """A random field over the plane of a surface."""

    def __init__(
        self, rng: np.random.Generator, contrast: float, across: float, along: float, angle: float = 0.0
    ) -> None:
        """Draw one.

        Args:
            rng: Source of randomness.
            contrast: Standard deviation.
            across: Correlation length across the streaks [m].
            along: Correlation length along the streaks [m].
            angle: Direction of the streaks from z towards -y [rad].
        """
        self._tile = _tile(int(rng.integers(_BANK)))[:: rng.choice([-1, 1]), :: rng.choice([-1, 1])]
        self._tile = np.ascontiguousarray(self._tile * np.float32(contrast))
        self._start = rng.uniform(0.35, 0.65, 2) * TILE
        c, s = np.cos(angle), np.sin(angle)
        self._turn = np.array([[c / across, s / across], [-s / along, c / along]]) * PER_LENGTH

    def __call__(self, y: Float32Array, z: Float32Array) -> Float32Array:
        """Value at surface coordinates y, z [m], shape (n, m) each; same shape."""
        (a, b), (c, d) = self._turn.astype(np.float32)
        at_x = a * y + b * z + np.float32(self._start[0])
        at_y = c * y + d * z + np.float32(self._start[1])
        field: Float32Array = cv2.remap(self._tile, at_x, at_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        return field
