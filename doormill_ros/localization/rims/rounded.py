"""A rounded arris: the face darkens evenly towards its outline and ends there with what is left of the step.

A lens, a disc and fibres spread a step alike to both sides, a rounded arris to the inside only: slope, then step. How
much is left at the outline depends on the light; nearly nothing, and where the slope ends is hardly seen. So every
share that may be left is tried, and what the profile says of it weighs where each of them has the outline. Both edges
were rounded together and are seen by one lens: what one shows of width and blur tells where the other ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
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
_WHOLE = 0.85  # from that share on nothing that matters has been rounded
# Squared deviations by which a rounded arris must fit better than all that spreads a step evenly: of 390 views without
# one two had 4.7 and 5.7.
_GAIN = 6.0
_WIDTHS = (1.3, 2.2, 3.6)  # px that fits begin with
_THINNEST = 0.3  # px; narrower ones are one step
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
    """

    left: FloatArray
    squares: FloatArray
    places: FloatArray
    covariances: FloatArray
    scale: float

    @property
    def weights(self) -> FloatArray:
        """How likely each is, shape (n,)."""
        likely = np.exp(-0.5 * (self.squares - self.squares.min()))
        return np.asarray(likely / likely.sum(), dtype=float)

    @property
    def likeliest(self) -> float:
        """Share left that explains the profile best."""
        return float(self.left[np.argmin(self.squares)])

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
    found = _scanned(profile, pixel)
    if found is None or found.likeliest > _WHOLE:
        return None
    best, mean, whiten = float(found.squares.min()), profile.mean, profile.whiten
    blur = profile.spread.blur
    least = best + _GAIN

    def as_good(fit: StepFit) -> bool:
        return profile.squares(fit) <= least * found.scale

    if as_good(fit_one(mean, whiten, blur)):
        return None
    if rim is not None and as_good(fit_two(mean, whiten, np.array([rim.shift, rim.width, rim.blur]))):
        return None
    spreads = ((1.2, 0.6), (0.8, 0.9))
    if any(as_good(fit(mean, whiten, a * blur, b * blur)) for fit in (fit_soft_disc, fit_ramp) for a, b in spreads):
        return None
    # What is alike from both ends is the camera's doing. Half as many numbers are left of a profile laid on itself.
    alike = float(np.sum(np.square(whiten @ mirrored(mean, whiten).rest)))
    if alike / (mean.size / 2) <= best * found.scale / (mean.size - _PARAMETERS):
        return None
    return found


def like_other(profile: Profile, other: Rounded, pixel: float) -> Rounded | None:
    """An edge read as rounded as wide as the other one, and seen as sharp; None where it cannot be read so."""
    return _scanned(profile, pixel, other.told())


def _scanned(profile: Profile, pixel: float, known: Known | None = None) -> Rounded | None:
    """The profile as a rounded arris with each share left, None where it is one with none of them."""
    mean, whiten = profile.mean, profile.whiten
    fits: dict[int, StepFit] = {}
    left = _LEFT if known is not None else _LEFT[:-1]
    first = [
        fit_rounded(mean, whiten, start, left[_FIRST], known) for start in _starts(profile, left[_FIRST], known)
    ]
    fits[_FIRST] = min(first, key=lambda fit: (fit.places[1] < _THINNEST, fit.misfit))
    for way in (range(_FIRST - 1, -1, -1), range(_FIRST + 1, left.size)):
        before = _FIRST
        for number in way:
            start = fits[before].places
            if known is None and start[1] < _THINNEST:
                start = _starts(profile, left[number], None)[1]
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


def _starts(profile: Profile, left: float, known: Known | None) -> list[FloatArray]:
    """Places that are as soft as the profile, shape (3,) each [px]."""
    if known is not None:
        _, width, blur = known.places
        return [np.array([0.5 * width * (1.0 - left), width, blur])]
    share = 1.0 - left
    spread = share / 3.0 - share**2 / 4.0  # square of what a slope adds to the blur, as a share of its width's
    return [
        np.array([0.5 * width * share, width, np.sqrt(max(profile.spread.blur**2 - spread * width**2, 0.3))])
        for width in _WIDTHS
    ]


def _is_arris(fit: StepFit, pixel: float) -> bool:
    """Whether a fit can be an arris: no wider than one, and seen through a lens."""
    _, width, blur = fit.places
    return bool(_THINNEST < width and width * pixel < 1.2 * NARROW and blur > 0.25 and fit.heights[0] > 0)
