"""A rim along an edge, too narrow to be a strip of its own: a broken, burnt or polished arris, a thin edge band.

It shifts the one step that is fitted to each row. All rows laid over each other show it: their mean profile is two
steps a few pixels apart, of which the outer one is the edge. What a soft lens does to one step is told from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.edge_points.blur import Spread, bin_places
from doormill_ros.localization.edge_points.step_grid import WIDEST, two_starts
from doormill_ros.localization.edge_points.step_models import blurred_step
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.rims.processing import mirrored
from doormill_ros.localization.rims.step_fits import Sharp, fit_disc, fit_one, fit_ramp, fit_two
from doormill_ros.units import m_to_mm

_MODEL = 4.0e-3  # how far a true point spread is from a modelled one, as a share of the step
_FITS = 0.85  # a misfit of one step below that, in standard deviations, is none
_CLEAR, _CLEAN = 1.1, 0.01
_SUSPECT = 1.15
# A rim half as dark as the background, narrower than so many blurs, looks like a fibrous edge.
EVEN, _UNRESOLVED = 0.13, 2.6
_BETTER, _MORE = 0.6, 0.35  # two steps must fit by that factor better, and by that much in squared deviations
_STREAKS = 5.0  # and that many standard deviations of streaks
FAINTEST = 0.1  #: brightness of a rim against the face, as a share of the step
NARROW = 0.42e-3  #: a darker rim may as well lie behind the face, unless it is an arris: so narrow [m]
_READABLE = 4.0  # blurs: where a narrower one ends is not seen
PLACED = 0.3  #: largest standard deviation of its outer border [px]
_SOFTER = 1.12  # an edge that much softer than one with a rim has one too
_SAME = 0.03  # by how much two edges differ in blur, as a share


@dataclass(frozen=True)
class Rim:
    """A rim along an edge.

    Attributes:
        shift: Its outer border, from the line fitted as if there were one step, outwards [px].
        deviation: Standard deviation of it [px].
        width: How wide it is [px].
        brightness: Rim minus face, as a share of face minus background; negative when darker.
        blur: Standard deviation of the point spread [px].
        misfit: RMS difference of the mean profile from the two steps, as a share of their sum.
        gap: Whether what lies beyond differs from the face the other way round: then it is a gap before another thing.
        rounded: Whether it darkens evenly from the face to its outer border; see `rounded.py`.
    """

    shift: float
    deviation: float
    width: float
    brightness: float
    blur: float
    misfit: float
    gap: bool = False
    rounded: bool = False


def suspicious(spread: Spread, streaks: float) -> bool:
    """Whether a mean profile differs from one step by more than chance and streaks, a share of the step, allow."""
    return bool(spread.misfit > _SUSPECT * np.sqrt(spread.level**2 + _MODEL**2 + 0.25 * streaks**2))


def find_rim(spread: Spread, streaks: float, sharp: float | None = None) -> Rim | None:
    """The rim that a mean profile shows, or None.

    Args:
        spread: Rows laid over each other, windows wide enough for the rim.
        streaks: Standard deviation of what all rows have in common beside the edge, as a share of the step.
        sharp: Blur of the other edge, where a rim shows along that one: one lens sees both [px].
    """
    profile = spread.mean
    # Behind the face there are fewer streaks.
    face = np.sqrt(1.0 - 0.75 * blurred_step(bin_places(profile.size), spread.blur))
    weight = 1.0 / np.sqrt(spread.error**2 + _MODEL**2 + (streaks * face) ** 2)
    known = None if sharp is None else Sharp(sharp, _SAME * sharp)
    plain = fit_one(profile, weight, spread.blur).misfit
    if sharp is None:
        if plain < _FITS:
            return None
        plain = min(plain, fit_disc(profile, weight, min(2 * spread.blur, 11.0)).misfit)
    else:
        plain = fit_one(profile, weight, sharp, known).misfit
    starts = two_starts(profile, weight)
    near = np.array([1.5, 1.8, 0.8]) * spread.blur  # narrower than the grid tells from one step
    tries = []
    for start in (starts[0], near, *starts[1:]):
        tries.append(fit_two(profile, weight, start, known))
        best = min(tries, key=lambda found: (found.places[1] < 0, found.misfit))
        if best.places[1] > 0 and best.misfit < 0.5 * _BETTER * plain:
            break
    shift, width, blur = (float(v) for v in best.places)
    if width < 0 or blur < 0 or width > WIDEST + 2:
        return None
    two, total = best.misfit, float(best.heights.sum())
    brightness = float(-best.heights[1] / total) if abs(total) > 1e-6 else 0.0
    if plain**2 - two**2 < _MORE or abs(brightness) < max(FAINTEST, _STREAKS * streaks):
        return None
    if two > _BETTER * plain and (plain < _CLEAR or streaks > _CLEAN):
        return None
    if abs(brightness + 0.5) > EVEN and two > _BETTER * _symmetric(spread, weight):
        return None
    if known is None and abs(brightness + 0.5) < EVEN and width < _UNRESOLVED * blur:
        # What thins out evenly looks much the same, and there the edge is in the middle.
        ramp = fit_ramp(profile, weight, 0.9 * width, blur).misfit
        if two > _BETTER * ramp:
            return None
    gap = total < 0.0 < best.heights[1]
    if gap and two > _CLEAR:
        return None
    return Rim(shift, best.deviation * max(two, 1.0), width, brightness, blur, two * _MODEL, bool(gap))


def _symmetric(spread: Spread, weight: FloatArray) -> float:
    """RMS of the weighted residuals of the best step that is alike from both ends, by weights (m,)."""
    return float(np.sqrt(np.mean(np.square(weight * mirrored(spread.at_middles(), weight).rest))))


def wide_and_dark(rim: Rim, pixel: float) -> bool:
    """Whether a rim may as well lie behind the face: too wide for an arris, and no polished one."""
    return rim.brightness < 0 and rim.width * pixel > NARROW and not rim.rounded


def check_placed(edge: str, rim: Rim, pixel: float) -> None:
    """Whether a rim's outer border is placed, by the size of a pixel on the face [m].

    Raises:
        WrongEdge: It is not.
    """
    if rim.deviation > PLACED:
        what = "a rounded arris" if rim.rounded else "a rim"
        raise WrongEdge(
            f"the {edge} edge is not one step from face to background: {what} lies along it, whose outer border is "
            f"known to {m_to_mm(min(rim.deviation * pixel, 1e-3)):.2f} mm only, allowed are "
            f"{m_to_mm(PLACED * pixel):.2f} mm; clean the edge, change the light or switch the camera's "
            "sharpening off",
            edge=edge,
        )


def check_readable(edge: str, rim: Rim, pixel: float) -> None:
    """Whether a wide dark rim is sharp enough that its end tells on which side of it the edge of the face is.

    Raises:
        WrongEdge: It is not.
    """
    if wide_and_dark(rim, pixel) and rim.width < _READABLE * rim.blur:
        raise WrongEdge(
            f"two steps {m_to_mm(rim.width * pixel):.2f} mm apart may be the {edge} edge: the inner one if the dark "
            "rim between them lies behind the face, the outer one if it is a band on the face; change the light or "
            "clean the edge",
            edge=edge,
        )


def softer(blur: float, sharp: float) -> bool:
    """Whether an edge is softer than one along which a rim lies [px]: then a rim lies along it, too."""
    return blur > _SOFTER * sharp


def check_alike(rims: dict[str, Rim | None], blurs: dict[str, float]) -> None:
    """Whether edges on which no rim was found are as sharp as those with a dark one; a softer one hides its own.

    Args:
        rims: What was found along each edge.
        blurs: Blur of each edge, a rim taken for what it is [px].

    Raises:
        WrongEdge: An edge is softer.
    """
    sharp = [rim.blur for rim in rims.values() if rim is not None and rim.brightness < 0]
    for edge, rim in rims.items():
        if rim is None and sharp and softer(blurs[edge], min(sharp)):
            raise WrongEdge(
                f"the {edge} edge is {blurs[edge]:.2f} px soft, the other, along which a dark rim lies, "
                f"{min(sharp):.2f} px: a rim hides in it, whose border cannot be placed; clean the edges or "
                "change the light",
                edge=edge,
            )
