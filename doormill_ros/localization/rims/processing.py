"""What a camera has done to a picture that looks like a rim along the edge: sharpening, smoothing, few grey levels.

A sharpened edge is darker than the background on one side of it and by as much brighter than the face on the other,
and no lens does that. It, and an edge smoothed on both sides, are alike seen from both ends; a rim lies on one side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from doormill_ros.arrays import ByteArray, FloatArray, IntArray
from doormill_ros.localization.edge_points.blur import Spread, bin_places
from doormill_ros.localization.errors import ProcessedPicture

_FURTHEST = 2.0  # px that the middle of a profile is looked for from the line
_MIDDLES = np.linspace(-_FURTHEST, _FURTHEST, 81)  # px
_FAR = 3.0  # px at both ends of a profile that are face and background
_NEAR = 0.5  # px from the edge; what a camera adds begins there
_OVERSHOOT, _OF_OTHER = 0.012, 0.3  # least one, as a share of the step and of that on the other side
_ERRORS, _STREAKS = 5.0, 3.0  # standard deviations that it exceeds
_FAINT = 0.3  # of all these where a rim darker than the background was seen, which is half of it
_EVERY = 12  # rows and columns of a picture whose grey levels are counted
_COARSEST = 6  # grey levels from one that a picture has to the next


@dataclass(frozen=True, eq=False)
class Mirrored:
    """How a profile differs from itself seen from the other end.

    Attributes:
        middle: Where both are most alike, from the line outwards [px].
        rest: What they differ by, shape (m,); as large as errors of the profile where it is alike from both ends.
    """

    middle: float
    rest: FloatArray


def mirrored(profile: FloatArray, weight: FloatArray) -> Mirrored:
    """A profile (m,) against itself from the other end, bins by weights (m,) or (m, m)."""
    rest = np.sqrt(0.5) * (profile + _turning(profile.size).dot(profile))
    whole = weight if weight.ndim == 2 else np.diag(weight)
    white, level = rest.dot(whole.T), whole.dot(np.full(profile.size, np.sqrt(0.5)))
    height = white.dot(level) / level.dot(level)
    left = np.square(white - height[:, None] * level).sum(axis=1)
    best = int(np.argmin(left))
    return Mirrored(float(_MIDDLES[best]), rest[best] - height[best] * np.sqrt(0.5))


@lru_cache(maxsize=4)
def _turning(size: int) -> FloatArray:
    """What makes a profile (m,) itself seen from the other end about each of _MIDDLES: a spline; shape (81, m, m)."""
    place = bin_places(size)
    # Beyond its ends it goes on as it is there.
    at = np.clip(2 * _MIDDLES[:, None] - place, place[0], place[-1])
    turning: FloatArray = CubicSpline(place, np.eye(size))(at)
    return turning


def overshoots(spread: Spread) -> tuple[float, float]:
    """How far a mean profile goes beyond its ends before it comes to them, inside and outside, shares of the step."""
    profile = spread.at_middles()
    place = bin_places(profile.size)
    far = round(_FAR / (place[1] - place[0]))
    smooth = np.convolve(profile, np.full(3, 1 / 3), mode="same")
    low, high = profile[:far].mean(), profile[-far:].mean()
    middle = place[np.argmin(np.abs(profile - 0.5 * (low + high)))]
    between, place = smooth[far:-far], place[far:-far]
    inside = low - np.min(between, where=place < middle - _NEAR, initial=low)
    outside = np.max(between, where=place > middle + _NEAR, initial=high) - high
    return float(inside / (high - low)), float(outside / (high - low))


def check_overshoot(edge: str, spread: Spread, streaks: float, rim: bool = False) -> None:
    """Whether an edge was sharpened by the camera.

    Args:
        edge: "hinge" or "bottom".
        spread: Its rows laid over each other in wide windows.
        streaks: Standard deviation of what all rows have in common beside the edge, as a share of the step.
        rim: Whether a rim darker than the background seems to lie along it.

    Raises:
        ProcessedPicture: It was.
    """
    small, large = sorted(overshoots(spread))
    least = (_FAINT if rim else 1.0) * max(_OVERSHOOT, _ERRORS * spread.level, _STREAKS * streaks)
    if small > least and small > _OF_OTHER * large:
        raise ProcessedPicture(
            f"beside the {edge} edge the picture is brighter than the face and darker than the background by "
            f"{100 * small:.1f} % of the step, as no lens shows it: the camera has sharpened it; switch sharpening and "
            "all other processing of the picture off",
            edge=edge,
            overshoot=small,
        )


def level_counts(picture: ByteArray) -> IntArray:
    """How often a picture (h, w), uint8, has each grey level in some of its rows and columns, shape (256,)."""
    return np.bincount(picture[_EVERY // 3 :: _EVERY, _EVERY // 3 :: _EVERY].ravel(), minlength=256)


def check_levels(counts: IntArray) -> None:
    """Whether a picture has grey levels next to each other, by its `level_counts`.

    Raises:
        ProcessedPicture: It has few that are far apart.
    """
    seen = np.flatnonzero(counts)
    apart = int(np.diff(seen).min()) if seen.size > 2 else 0
    if apart > _COARSEST:
        raise ProcessedPicture(
            f"the picture has {seen.size} grey levels, {apart} apart, allowed are {_COARSEST}: the camera rounds them; "
            "set it to 8 bit grey and switch all other processing of the picture off",
            levels=int(seen.size),
        )
