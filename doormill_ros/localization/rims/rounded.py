"""A rounded arris: the face darkens evenly towards its outline and ends there with what is left of the step.

A lens, a disc and fibres spread a step alike to both sides, a rounded arris to the inside only: slope, then step. How
much is left at the outline depends on the light; nearly nothing, and where the slope ends is hardly seen. So every
share that may be left is tried, and what the profile says of it weighs where each of them has the outline. Both edges
were rounded together and are seen by one lens: what one shows of width and blur tells where the other ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from math import isfinite

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.edge_points.blur import bin_places
from doormill_ros.localization.edge_points.step_models import RoundedStep, blurred_step
from doormill_ros.localization.rims.arris import Profile
from doormill_ros.localization.rims.processing import mirrored
from doormill_ros.localization.rims.rim import NARROW, Rim
from doormill_ros.localization.rims.step_fits import (
    Known,
    StepFit,
    fit_one,
    fit_ramp,
    fit_rounded,
    fit_soft_disc,
    fit_two,
)

# What may be left of the step at the outline; below 0 where the background is lighter than the arris.
_LEFT = np.round(np.arange(-0.3, 1.01, 0.1), 1)
_FIRST = 6  # of these the one that fits begin with
_LIGHTEST = 0.75  # what leaves more hardly moves the edge, and chips leave such a trail inside of one
_UNLIKE = 2.75  # squares, as a factor on what is expected, of a profile that is something else
# Squared deviations by which a rounded arris must fit better than all that spreads a step evenly, along both edges
# together: of 1600 edges without one, none had 7.5. From the least on an edge counts.
_GAIN, _LEAST = 9.0, 3.0
_HINT = 3.0  # of what is so near to one step that it is linear; then it is looked at as it is
_SHARES = (0.2, 0.4, 0.65)  # looked for so
_SPREADS = (1.2, 0.6), (0.8, 0.9)  # reach and blur that even spreads begin with, as shares of the blur
_WIDTHS = (1.6, 3.0)  # px that fits begin with
_THINNEST = 0.3  # px; narrower ones are one step
_WIDEST = 1.05 * NARROW  # m
_SHARPEST = 0.25  # px
_BLUR_STEP = 0.05  # px between blurs for which shapes are kept
_SAME_WIDTH, _SAME_BLUR = 0.12, 0.04  # by how much two edges differ, as shares
_PARAMETERS = 6


@dataclass(frozen=True, eq=False)
class Rounded:
    """An edge read as a rounded arris with one share left at the outline after the other.

    Attributes:
        left: These shares, shape (n,).
        squares: Squared deviations that each leaves, as shares of what all leave of one, shape (n,).
        places: Outline, width and blur with each, shape (n, 3) [px].
        covariances: Of these, shape (n, 3, 3) [px^2].
        scale: By how much more than expected the best of them leaves, as a factor on squares.
        gain: By how many squared deviations less than all that spreads a step evenly.
    """

    left: FloatArray
    squares: FloatArray
    places: FloatArray
    covariances: FloatArray
    scale: float
    gain: float = 0.0

    @property
    def weights(self) -> FloatArray:
        """How likely each is, shape (n,)."""
        likely = np.exp(-0.5 * (self.squares - self.squares.min()))
        return np.asarray(likely / likely.sum(), dtype=float)

    def mean(self) -> FloatArray:
        """Outline, width and blur, shape (3,) [px]."""
        return np.asarray(self.weights @ self.places, dtype=float)

    def covariance(self) -> FloatArray:
        """Of outline, width and blur, shape (3, 3) [px^2]."""
        off = self.places - self.mean()
        each = self.covariances + off[:, :, None] * off[:, None, :]
        return np.asarray(np.tensordot(self.weights, each, 1), dtype=float)

    def told(self) -> Known:
        """What it tells of the other edge: width and blur."""
        mean, covariance = self.mean(), self.covariance()
        among = covariance[1:, 1:] + np.diag([(_SAME_WIDTH * mean[1]) ** 2, (_SAME_BLUR * mean[2]) ** 2])
        precision = np.zeros((3, 3))
        precision[1:, 1:] = np.linalg.inv(among)
        return Known(np.array([0.0, *mean[1:]]), precision)

    def rim(self, profile: Profile) -> Rim:
        """The rim of a profile that is this."""
        shift, width, blur = self.mean().tolist()
        dark = 1.0 - float(self.weights @ self.left)
        misfit = float(np.sqrt(self.squares.min() * self.scale / profile.mean.size))
        deviation = float(np.sqrt(self.covariance()[0, 0]))
        return Rim(shift, deviation, width, -dark, blur, misfit * profile.spread.level, rounded=True)


def find_rounded(profile: Profile, rim: Rim | None, pixel: float) -> Rounded | None:
    """A rounded arris where it explains the profile better than what spreads a step evenly and than a rim does.

    Args:
        profile: Of an edge, over wide windows.
        rim: That was found in it.
        pixel: Size of one on the face [m].
    """
    mean, whiten, blur = profile.mean, profile.whiten, profile.spread.blur
    if _leaning(profile) < _HINT:
        return None
    found = _scanned(profile, pixel)
    if found is None or found.scale > _UNLIKE:
        return None
    # A background lighter than the arris is no reason to look for one.
    squares = np.where(found.left < 0.0, np.inf, found.squares)
    best = float(squares.min()) * found.scale
    if not isfinite(best) or found.left[squares.argmin()] > _LIGHTEST:
        return None
    # What is alike from both ends is the camera's doing. Half as many numbers are left of a profile laid on itself.
    alike = float(np.sum(np.square(whiten @ mirrored(mean, whiten).rest)))
    if alike / (mean.size / 2) <= best / (mean.size - _PARAMETERS):
        return None
    rivals = [fit_one(mean, whiten, blur)]
    for reach, soft in _SPREADS:
        rivals += [fit(mean, whiten, reach * blur, soft * blur) for fit in (fit_soft_disc, fit_ramp)]
    if rim is not None:
        rivals.append(fit_two(mean, whiten, np.array([rim.shift, rim.width, rim.blur])))
    gain = (min(profile.squares(fit) for fit in rivals) - best) / found.scale
    return replace(found, gain=gain) if gain > _LEAST else None


def both_rounded(
    found: Mapping[str, Rounded], profiles: Mapping[str, Profile], pixel: float
) -> dict[str, Rim]:
    """The rims of both edges where a rounded arris was found, and by that of the other edge where it was not.

    Args:
        found: By edge, what was found.
        profiles: By edge, over wide windows, of all that may be rounded.
        pixel: Size of one on the face [m].
    """
    if sum(one.gain for one in found.values()) < _GAIN:
        return {}
    told = {edge: other.told() for edge in profiles for name, other in found.items() if name != edge}
    placed = dict(found)
    for edge, known in told.items():
        read = _scanned(profiles[edge], pixel, known)
        if read is not None:
            placed[edge] = read
    return {edge: one.rim(profiles[edge]) for edge, one in placed.items()}


def _leaning(profile: Profile) -> float:
    """Squared deviations that a slope towards the inside may explain beyond a step that is spread evenly."""
    plain, slopes = _shapes(profile.mean.size, round(profile.spread.blur / _BLUR_STEP) * _BLUR_STEP)
    known = len(plain)
    columns = profile.whiten @ np.vstack((plain, slopes, profile.mean)).T
    basis, _ = np.linalg.qr(columns[:, :known])
    rest = columns[:, known:] - basis @ (basis.T @ columns[:, known:])
    along, own = rest[:, :-1].T @ rest[:, -1], np.square(rest[:, :-1]).sum(axis=0)
    return float(np.max(np.maximum(along, 0.0) ** 2 / own))


@lru_cache(maxsize=64)
def _shapes(size: int, blur: float) -> tuple[FloatArray, FloatArray]:
    """What spreads a step evenly, shape (k, m), and rounded arrises as soft as it, shape (n, m)."""
    place, near = bin_places(size), 0.1 * blur
    plain = [np.ones_like(place), blurred_step(place, blur)]
    plain += [blurred_step(place - near, blur), blurred_step(place, blur + near)]
    # With nothing left at its end a slope spreads a step evenly.
    plain.append(RoundedStep(size, 0.0).at(_starts(blur, 0.0, None)[-1].tolist())[1])
    slopes = [(left, start) for left in _SHARES for start in _starts(blur, left, None)]
    return np.array(plain), np.array(
        [RoundedStep(size, left).at(start.tolist())[1] for left, start in slopes]
    )


def _scanned(profile: Profile, pixel: float, known: Known | None = None) -> Rounded | None:
    """The profile as a rounded arris with each share left, None where it is one with none of them."""
    mean, whiten = profile.mean, profile.whiten
    fits: dict[int, StepFit] = {}
    left = _LEFT if known is not None else _LEFT[:-1]
    fits[_FIRST] = _first(profile, known)
    for way in (range(_FIRST - 1, -1, -1), range(_FIRST + 1, left.size)):
        before = _FIRST
        for number in way:
            start = fits[before].places
            if known is None and start[1] < _THINNEST:
                start = _starts(profile.spread.blur, left[number], None)[0]
            else:
                start = start + np.array([0.5 * start[1] * (left[before] - left[number]), 0.0, 0.0])
            fits[number] = fit_rounded(mean, whiten, start, left[number], known)
            before = number
    good = [number for number, fit in sorted(fits.items()) if _is_arris(fit, pixel)]
    if not good:
        return None
    squares = np.array([profile.squares(fits[number]) for number in good])
    scale = max(float(squares.min()) / (mean.size - _PARAMETERS), 1.0)
    return Rounded(
        left[good],
        squares / scale,
        np.array([fits[number].places for number in good]),
        scale * np.array([fits[number].covariance for number in good]),
        scale,
    )


def _first(profile: Profile, known: Known | None) -> StepFit:
    """The fit that the others begin with."""
    left = float(_LEFT[_FIRST])
    starts = _starts(profile.spread.blur, left, known)
    fits = [fit_rounded(profile.mean, profile.whiten, start, left, known) for start in starts]
    return min(fits, key=lambda fit: (fit.places[1] < _THINNEST, fit.misfit))


def _starts(blur: float, left: float, known: Known | None) -> list[FloatArray]:
    """Places that are as soft as one step of that blur, shape (3,) each [px]."""
    if known is not None:
        _, width, sharp = known.places
        return [np.array([0.5 * width * (1.0 - left), width, sharp])]
    share = 1.0 - left
    # Square of what the slope adds to the blur, as a share of that of its width.
    spread = share / 3.0 - share**2 / 4.0
    return [
        np.array([0.5 * width * share, width, np.sqrt(max(blur**2 - spread * width**2, 0.3))])
        for width in _WIDTHS
    ]


def _is_arris(fit: StepFit, pixel: float) -> bool:
    """Whether a fit can be an arris: no wider than one, and seen through a lens."""
    _, width, blur = fit.places
    seen = np.isfinite(fit.covariance).all() and blur > _SHARPEST and fit.heights[0] > 0
    return bool(seen and width > _THINNEST and width * pixel < _WIDEST)
