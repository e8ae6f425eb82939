"""A rim along an edge, too narrow to be a strip of its own: a broken, burnt or polished arris, a thin edge band.

It shifts the one step that is fitted to each row. All rows laid over each other show it: their mean profile is two
steps a few pixels apart, of which the outer one is the edge. What a soft lens does to one step is told from it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares
from scipy.special import ndtr

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.blur import Spread, bin_places
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.texture import PIXEL_VARIANCE
from doormill_ros.units import m_to_mm

_MODEL = 4.0e-3  # how far a true point spread is from a modelled one, as a share of the step
_FITS = 0.85  # a misfit of one step below that, in standard deviations, is none
_CLEAR, _CLEAN = 1.1, 0.01
_SUSPECT = 1.15
# A rim half as dark as the background, narrower than so many blurs, looks like a soft lens and shifts no edge.
_EVEN, _UNRESOLVED = 0.13, 2.6
_BETTER, _MORE = 0.6, 0.35  # two steps must fit by that factor better, and by that much in squared deviations
_STREAKS = 5.0  # and that many standard deviations of streaks
_FAINTEST = 0.1  # brightness of a rim against the face, as a share of the step
_NARROW = 0.42e-3  # a darker rim may as well lie behind the face, unless it is an arris: so narrow [m]
_PLACED = 0.3  # largest standard deviation of its outer border [px]
_SOFTER = 1.12  # an edge that much softer than one with a rim has one too
_RIDGE = 1.0e-6  # keeps least squares solvable where two steps coincide
_WIDTHS = np.geomspace(1.0, 11.0, 12)  # px
_BLURS = np.array([0.6, 0.9, 1.3, 1.9, 2.8])  # px
_SHIFTS = np.arange(-4.0, 6.1, 0.5)  # px


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
    """

    shift: float
    deviation: float
    width: float
    brightness: float
    blur: float
    misfit: float


def _step(place: FloatArray, blur: FloatArray | float) -> FloatArray:
    sharp: FloatArray = ndtr(place / np.sqrt(np.square(blur) + PIXEL_VARIANCE))
    return sharp


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(15)
_DISC = _WEIGHTS * np.sqrt(1 - _NODES**2)  # a disc seen edge on
_DISC /= _DISC.sum()


def _disc_step(place: FloatArray, radius: float, blur: float) -> FloatArray:
    """A step seen by a defocused lens, whose point spread is a disc."""
    seen: FloatArray = _step(place[:, None] - radius * _NODES, blur) @ _DISC
    return seen


def _solved(
    columns: list[FloatArray], profile: FloatArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Weighted residuals and coefficients of least squares."""
    design = np.stack(columns, axis=1) * weight[:, None]
    normal = design.T @ design + _RIDGE * np.eye(len(columns))
    found = np.asarray(np.linalg.solve(normal, design.T @ (profile * weight)), dtype=float)
    return design @ found - profile * weight, found


@lru_cache(maxsize=4)
def _grid(size: int) -> tuple[FloatArray, FloatArray]:
    """Parameters (g, 3) of shift, width and blur, and their two steps (g, 2, m)."""
    place = bin_places(size)
    shift, width, blur = (a.ravel() for a in np.meshgrid(_SHIFTS, _WIDTHS, _BLURS, indexing="ij"))
    outer = _step(place - shift[:, None], blur[:, None])
    inner = _step(place - (shift - width)[:, None], blur[:, None])
    return np.stack([shift, width, blur], axis=1), np.stack([outer, inner], axis=1)


def _start(profile: FloatArray, weight: FloatArray, few: int = 2) -> tuple[FloatArray, float]:
    """The best parameters (few, 3) of the grid, and the cost of the best."""
    parameters, steps = _grid(profile.size)
    square = weight**2
    design = np.concatenate([np.broadcast_to(1.0, (len(steps), 1, profile.size)), steps], axis=1)
    weighted = design * square
    normal = weighted @ np.swapaxes(design, 1, 2) + _RIDGE * np.eye(3)
    moment = weighted @ profile
    found = np.linalg.solve(normal, moment[..., None])[..., 0]
    explained = np.einsum("gi,gi->g", moment, found)
    order = np.argsort(-explained)
    picked = [order[0]]
    for i in order[1:]:
        if len(picked) == few:
            break
        if all(abs(parameters[i, 1] / parameters[j, 1] - 1) > 0.5 for j in picked):
            picked.append(i)
    return parameters[picked], float(0.5 * ((square * profile) @ profile - explained[order[0]]))


def suspicious(spread: Spread, streaks: float) -> bool:
    """Whether a mean profile differs from one step by more than chance and streaks, a share of the step, allow."""
    return bool(spread.misfit > _SUSPECT * np.sqrt(spread.level**2 + _MODEL**2 + 0.25 * streaks**2))


def find_rim(spread: Spread, streaks: float) -> Rim | None:
    """The rim that a mean profile shows, or None.

    Args:
        spread: Rows laid over each other, windows wide enough for the rim.
        streaks: Standard deviation of what all rows have in common beside the edge, as a share of the step.
    """
    profile, place = spread.mean, bin_places(spread.mean.size)
    face = np.sqrt(1.0 - 0.75 * _step(place, spread.blur))  # behind the face there are less of them
    weight = 1.0 / np.sqrt(spread.error**2 + _MODEL**2 + (streaks * face) ** 2)
    one = np.ones_like(place)

    def misfit(cost: float) -> float:
        return float(np.sqrt(2 * cost / place.size))

    def single(p: FloatArray) -> FloatArray:
        return _solved([one, _step(place - p[0], p[1])], profile, weight)[0]

    def disc(p: FloatArray) -> FloatArray:
        return _solved([one, _disc_step(place - p[0], p[1], 0.5)], profile, weight)[0]

    plain = misfit(least_squares(single, [0.0, spread.blur], method="lm", max_nfev=40).cost)
    starts, least = _start(profile, weight)
    if plain < _FITS or plain**2 - misfit(least) ** 2 < 0.5 * _MORE:
        return None
    softest = [0.0, min(2 * spread.blur, 11.0)]
    plain = min(plain, misfit(least_squares(disc, softest, method="lm", max_nfev=40).cost))

    def columns(p: FloatArray) -> list[FloatArray]:
        return [one, _step(place - p[0], p[2]), _step(place - p[0] + p[1], p[2])]

    def double(p: FloatArray) -> FloatArray:
        return _solved(columns(p), profile, weight)[0]

    tries = [least_squares(double, start, method="lm", max_nfev=60) for start in starts]
    best = min(tries, key=lambda found: (found.x[1] < 0, float(found.cost)))
    shift, width, blur = (float(v) for v in best.x)
    if width < 0 or blur < 0 or width > _WIDTHS[-1] + 2:
        return None
    two, steps = misfit(best.cost), _solved(columns(best.x), profile, weight)[1]
    total = steps[1] + steps[2]
    brightness = float(-steps[2] / total) if abs(total) > 1e-6 else 0.0
    if plain**2 - two**2 < _MORE or abs(brightness) < max(_FAINTEST, _STREAKS * streaks):
        return None
    covariance = np.linalg.pinv(best.jac.T @ best.jac) * max(two, 1.0) ** 2
    if two > _BETTER * plain and (plain < _CLEAR or streaks > _CLEAN):
        return None
    deviation = float(np.sqrt(covariance[0, 0]))
    if abs(brightness + 0.5) < _EVEN and width < _UNRESOLVED * blur:
        return None
    return Rim(shift, deviation, width, brightness, blur, two * _MODEL)


def wide_and_dark(rim: Rim, pixel: float) -> bool:
    """Whether a rim may as well lie behind the face: too wide for an arris, and no polished one."""
    return rim.brightness < 0 and rim.width * pixel > _NARROW


def check_rim(edge: str, rim: Rim, pixel: float) -> None:
    """Whether a rim belongs to the face for sure, and its border is placed.

    Raises:
        WrongEdge: It does not.
    """
    if rim.deviation > _PLACED:
        raise WrongEdge(
            f"the {edge} edge is not one step from face to background: a rim lies along it, whose outer border is "
            f"known to {m_to_mm(min(rim.deviation * pixel, 1e-3)):.2f} mm only, allowed are "
            f"{m_to_mm(_PLACED * pixel):.2f} mm; clean the edge or change the light",
            edge=edge,
        )
    if wide_and_dark(rim, pixel):
        raise WrongEdge(
            f"two steps {m_to_mm(rim.width * pixel):.2f} mm apart may be the {edge} edge: the inner one if the dark "
            "rim between them lies behind the face, the outer one if it is a band on the face; change the light or "
            "clean the edge",
            edge=edge,
        )


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
        if rim is None and sharp and blurs[edge] > _SOFTER * min(sharp):
            raise WrongEdge(
                f"the {edge} edge is {blurs[edge]:.2f} px soft, the other, along which a dark rim lies, "
                f"{min(sharp):.2f} px: a rim hides in it, whose border cannot be placed; clean the edges or "
                "change the light",
                edge=edge,
            )
