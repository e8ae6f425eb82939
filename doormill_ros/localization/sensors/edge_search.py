"""Sub-pixel points on a bright region's edge, searched across a guess of where the edge runs."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import BoolArray, ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.sensors.errors import EdgeNotFound
from doormill_ros.statistics import NORMAL_STD

_AGREE = 3.0  # px from the line that a coarse point may stand off
_WINDOW = 8.0  # px on both sides of the edge that the fine search looks at
_STEP = 0.5  # px between samples of the fine search
_MIN_SHARE = 0.5  # of the scan lines
_TRIES = 200


@dataclass(frozen=True, eq=False)
class EdgePoints:
    """Points found on an edge.

    Attributes:
        index: Which of the scan lines, shape (n,).
        pixels: Sub-pixel points u, v [px], shape (n, 2).
        deviation: Standard deviation across the edge from the picture's noise [px].
    """

    index: IntArray
    pixels: FloatArray
    deviation: float


def find_edge(
    picture: ByteArray,
    guess: FloatArray,
    inward: FloatArray,
    reach: float,
    noise: float,
    min_contrast: float,
    what: str,
) -> EdgePoints:
    """Find an edge near a guess of it.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        guess: Points where scan lines cross the guessed edge [px], shape (n, 2).
        inward: Unit vectors across the edge into the bright side, shape (n, 2).
        reach: How far the edge may be off [px].
        noise: Standard deviation of a grey value.
        min_contrast: Smallest step of grey levels.
        what: Name of the edge, for messages.

    Raises:
        EdgeNotFound: No line of enough steps, or too little contrast.
    """
    coarse = np.arange(-reach, reach + 1.0)
    profile = _sample(picture, guess, inward, coarse)  # (n, m)
    steep = np.gradient(cv2.blur(profile, (5, 1)), axis=1)
    offset = coarse[np.argmax(steep, axis=1)]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(guess, axis=0), axis=1))])
    agree, line = _line(along, offset)
    if agree.mean() < _MIN_SHARE:
        raise EdgeNotFound(
            f"{agree.mean():.0%} of the scan lines across {what} agree on a line, at least {_MIN_SHARE:.0%} "
            "are needed; clean the door and the lens",
            edge=what,
        )
    start = guess + (line[0] + line[1] * along)[:, None] * inward
    fine = np.arange(-_WINDOW, _WINDOW + _STEP / 2, _STEP)
    profile = _sample(picture, start, inward, fine)
    quarter = fine.size // 4
    dark, bright = profile[:, :quarter].mean(axis=1), profile[:, -quarter:].mean(axis=1)
    contrast = float(np.median(bright - dark))
    if contrast < min_contrast:
        raise EdgeNotFound(
            f"{what} has a contrast of {contrast:.0f} grey levels, at least {min_contrast:.0f} are needed; "
            "correct light or exposure",
            edge=what,
        )
    # The area under a step tells where it is, whatever the point spread.
    filled = (profile - dark[:, None]).sum(axis=1) / np.maximum(bright - dark, 1.0) * _STEP
    position = _WINDOW + _STEP / 2 - filled
    good = agree & (bright - dark > 0.6 * contrast) & (np.abs(position) < _WINDOW / 2)
    size = np.array(picture.shape[::-1]) - 1.0
    good &= np.all((start > _WINDOW) & (start < size - _WINDOW), axis=1)
    good &= _near(along, position, good)
    if good.mean() < _MIN_SHARE:
        raise EdgeNotFound(f"{good.mean():.0%} of {what} can be measured; clean the door", edge=what)
    index = np.flatnonzero(good)
    pixels = start[index] + position[index, None] * inward[index]
    # With the levels taken from the outer quarters every pixel of the window counts once, plus or minus.
    deviation = noise / contrast * np.sqrt(2.0 * _WINDOW)
    return EdgePoints(index, pixels, float(deviation))


def _sample(picture: ByteArray, at: FloatArray, across: FloatArray, offsets: FloatArray) -> Float32Array:
    """Grey values at `at` + offsets * `across`, shape (n, m), float32."""
    places = at[:, None] + offsets[None, :, None] * across[:, None]
    u, v = places[..., 0].astype(np.float32), places[..., 1].astype(np.float32)
    values = cv2.remap(picture, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(values, dtype=np.float32)


def _line(along: FloatArray, offset: FloatArray) -> tuple[BoolArray, FloatArray]:
    """The line offset = c0 + c1 along that most points agree with; which do, and (c0, c1)."""
    rng = np.random.default_rng(0)  # the same picture gives the same answer
    n, best = along.size, np.zeros(along.size, dtype=bool)
    for _ in range(_TRIES):
        i, j = rng.choice(n, 2, replace=False)
        slope = (offset[j] - offset[i]) / (along[j] - along[i])
        agree = np.abs(offset - offset[i] - slope * (along - along[i])) < _AGREE
        if agree.sum() > best.sum():
            best = agree
    slope, start = np.polyfit(along[best], offset[best], 1)
    return best, np.array([start, slope])


def _near(along: FloatArray, position: FloatArray, good: BoolArray) -> BoolArray:
    """Points within four robust standard deviations of the line through the good ones."""
    if good.sum() < 3:
        return good
    slope, start = np.polyfit(along[good], position[good], 1)
    off = np.abs(position - start - slope * along)
    near: BoolArray = off < 4.0 * max(NORMAL_STD * float(np.median(off[good])), 0.05)
    return near
