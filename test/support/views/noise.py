"""Tiles of random texture that repeat without a seam, and how they are looked up."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from support.views.optics import Array

TEXELS = 1024
_SEED = {"speckle": 11, "cloud": 12, "streak": 13, "pore": 14, "drift": 15}


@lru_cache(maxsize=8)
def tile(kind: str) -> Array:
    """A tile of zero mean and unit standard deviation, or pores between 0 and 1; float32 shape (TEXELS, TEXELS).

    Args:
        kind: speckle (a texel wide), cloud (of all widths), streak (long along rows of v), pore (short dashes along
            v, 0 to 1) or drift (one line of clouds along u only).
    """
    rng = np.random.default_rng(_SEED[kind])
    spectrum = np.fft.fft2(rng.standard_normal((TEXELS, TEXELS)))
    fu = np.fft.fftfreq(TEXELS)[None, :]
    fv = np.fft.fftfreq(TEXELS)[:, None]
    if kind == "speckle":
        gain = np.exp(-2.0 * (np.pi * 0.8) ** 2 * (fu**2 + fv**2))
    elif kind == "cloud":
        gain = 1.0 / np.maximum(np.hypot(fu, fv), 2.0 / TEXELS) ** 1.6
    elif kind == "streak":
        gain = (
            np.exp(-2.0 * np.pi**2 * ((0.9 * fu) ** 2 + (90.0 * fv) ** 2)) / (1.0 + (12.0 * fu) ** 2) ** 0.3
        )
    elif kind == "pore":
        gain = np.exp(-2.0 * np.pi**2 * ((0.7 * fu) ** 2 + (9.0 * fv) ** 2))
    else:
        gain = np.where(fv == 0.0, 1.0 / np.maximum(np.abs(fu), 3.0 / TEXELS) ** 1.4, 0.0)
    gain[0, 0] = 0.0
    field = np.fft.ifft2(spectrum * gain).real
    field /= field.std()
    if kind == "pore":
        field = np.clip((field - 1.6) / 0.6, 0.0, 1.0)
    found: Array = field.astype(np.float32)
    return found


def look_up(kind: str, u: Array, v: Array) -> Array:
    """Values of a tile at texels u, v, both of shape (n,)."""
    n = u.size
    rows = -(-n // 1024)
    maps = []
    for coordinate in (u, v):
        padded = np.zeros(rows * 1024, dtype=np.float32)
        padded[:n] = np.mod(coordinate.ravel(), TEXELS)
        maps.append(padded.reshape(rows, 1024))
    found: Array = np.empty((rows, 1024), dtype=np.float32)
    step = 16000  # OpenCV takes no picture of more than 32767 rows
    for first in range(0, rows, step):
        part = slice(first, first + step)
        found[part] = cv2.remap(
            tile(kind), maps[0][part], maps[1][part], cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP
        )
    return found.reshape(-1)[:n]


def smooth(x: Array) -> Array:
    """0 below 0, 1 above 1, smooth between."""
    t = np.clip(x, 0.0, 1.0)
    found: Array = t * t * (3.0 - 2.0 * t)
    return found
