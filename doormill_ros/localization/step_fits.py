"""Fits of one step, of two, and of one seen by a defocused lens to the mean profile of an edge.

Levenberg's and Marquardt's descent with derivatives in closed form; levels and heights are parameters as places are.
Weights are those of bins by themselves, shape (m,), or what makes errors that go together white, shape (m, m).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtr

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.blur import bin_places
from doormill_ros.localization.texture import PIXEL_VARIANCE

WIDEST = 11.0  #: px between two steps looked for
_RIDGE = 1.0e-6  # keeps least squares solvable where two steps coincide
_WIDTHS = np.geomspace(1.0, WIDEST, 12)  # px
_BLURS = np.array([0.6, 0.9, 1.3, 1.9, 2.8])  # px
_SHIFTS = np.arange(-4.0, 6.1, 0.5)  # px
_ENOUGH = 1.0e-5  # a fit ends where its squares fall by less, as a share
_DAMPED = 1.0e-3
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(15)
_DISC = _WEIGHTS * np.sqrt(1 - _NODES**2)  # a disc seen edge on
_DISC /= _DISC.sum()
_RAMP = _WEIGHTS / _WEIGHTS.sum()
_DISC_BLUR = 0.5  # px


@dataclass(frozen=True, eq=False)
class StepFit:
    """A fit.

    Attributes:
        places: Shift of the outer step [px], and what else the model has; see `fit_one`, `fit_disc` and `fit_two`.
        heights: Of the steps as shares of the edge's, shape (1,) or (2,).
        misfit: RMS of the weighted residuals, what is known of the blur among them.
        deviation: Standard deviation of the shift where the weights are those of the errors [px].
    """

    places: FloatArray
    heights: FloatArray
    misfit: float
    deviation: float


def blurred_step(place: FloatArray, blur: FloatArray | float) -> FloatArray:
    """A step of height 1 at distances `place` from it, both [px]; the pixel's own width is added to the blur."""
    sharp: FloatArray = ndtr(place / np.sqrt(np.square(blur) + PIXEL_VARIANCE))
    return sharp


def fit_one(profile: FloatArray, weight: FloatArray, blur: float, sharp: Sharp | None = None) -> StepFit:
    """One step in a profile (m,) of weights (m,); places are shift and blur [px], which starts from `blur`."""
    return _descend(_One(profile.size), profile, weight, np.array([0.0, blur]), sharp)


def fit_disc(profile: FloatArray, weight: FloatArray, radius: float) -> StepFit:
    """One step of a profile (m,), weights (m,), spread by a disc; places are shift and radius from `radius` [px]."""
    return _descend(_Spread(profile.size, _DISC), profile, weight, np.array([0.0, radius]), None)


def fit_soft_disc(profile: FloatArray, weight: FloatArray, radius: float, blur: float) -> StepFit:
    """One step of a profile (m,), weights (m,), spread by a disc and a lens; places are shift, radius, blur [px]."""
    return _descend(_Spread(profile.size, _DISC), profile, weight, np.array([0.0, radius, blur]), None)


def fit_ramp(profile: FloatArray, weight: FloatArray, reach: float, blur: float) -> StepFit:
    """An edge that thins out evenly, profile and weights (m,); places: shift, half width from `reach`, blur [px]."""
    return _descend(_Spread(profile.size, _RAMP), profile, weight, np.array([0.0, reach, blur]), None)


def fit_two(
    profile: FloatArray, weight: FloatArray, start: FloatArray, sharp: Sharp | None = None
) -> StepFit:
    """Two steps, profile and weights (m,); places: the outer's shift, how far inside the inner is, blur (3,) [px]."""
    return _descend(_Two(profile.size), profile, weight, start, sharp)


def nearness(profile: FloatArray, weight: FloatArray, places: FloatArray) -> float:
    """Squared deviations of a profile (m,) from two steps at `places` (3,), as in `fit_two`, of the best heights."""
    columns = _Two(profile.size).columns(places)
    left = _weighted(_solved(columns, profile, weight) @ columns - profile, weight)
    return float(left @ left)


@dataclass(frozen=True)
class Sharp:
    """A blur that is known beforehand, and its standard deviation [px]."""

    blur: float
    deviation: float


@dataclass(frozen=True)
class _One:
    size: int
    blur_at: int = 1

    def columns(self, p: FloatArray) -> FloatArray:
        """Level and steps, shape (1 + n, m)."""
        place = bin_places(self.size)
        return np.stack([np.ones(self.size), blurred_step(place - p[0], p[1])])

    def slopes(self, p: FloatArray, heights: FloatArray) -> FloatArray:
        """Derivative of the profile with respect to the places, shape (k, m)."""
        by_shift, by_blur = _slopes(bin_places(self.size) - p[0], p[1])
        slopes: FloatArray = heights[0] * np.stack([by_shift, by_blur])
        return slopes


@dataclass(frozen=True)
class _Two:
    size: int
    blur_at: int = 2

    def columns(self, p: FloatArray) -> FloatArray:
        place = bin_places(self.size) - p[0]
        return np.stack([np.ones(self.size), blurred_step(place, p[2]), blurred_step(place + p[1], p[2])])

    def slopes(self, p: FloatArray, heights: FloatArray) -> FloatArray:
        place = bin_places(self.size) - p[0]
        outer, outer_blur = _slopes(place, p[2])
        inner, inner_blur = _slopes(place + p[1], p[2])
        return np.stack(
            [
                heights[0] * outer + heights[1] * inner,
                -heights[1] * inner,
                heights[0] * outer_blur + heights[1] * inner_blur,
            ]
        )


@dataclass(frozen=True, eq=False)
class _Spread:
    size: int
    share: FloatArray  # of each of _NODES
    blur_at: int = 2

    def columns(self, p: FloatArray) -> FloatArray:
        place = (bin_places(self.size) - p[0])[:, None] - p[1] * _NODES
        return np.stack([np.ones(self.size), blurred_step(place, _blur(p)) @ self.share])

    def slopes(self, p: FloatArray, heights: FloatArray) -> FloatArray:
        place = (bin_places(self.size) - p[0])[:, None] - p[1] * _NODES
        by_shift, by_blur = _slopes(place, _blur(p))
        rows = [by_shift @ self.share, (by_shift * _NODES) @ self.share, by_blur @ self.share]
        slopes: FloatArray = heights[0] * np.stack(rows[: p.size])
        return slopes


def _blur(p: FloatArray) -> float:
    """That of a smeared step, fitted where it is among the places."""
    return float(p[2]) if p.size > 2 else _DISC_BLUR


def _slopes(place: FloatArray, blur: float) -> tuple[FloatArray, FloatArray]:
    """Derivatives of `blurred_step` with respect to the step's place and to the blur."""
    sigma = np.sqrt(blur**2 + PIXEL_VARIANCE)
    scaled = place / sigma
    by_shift = np.exp(-0.5 * scaled**2) / (-np.sqrt(2 * np.pi) * sigma)
    return by_shift, by_shift * scaled * (blur / sigma)


def _solved(columns: FloatArray, profile: FloatArray, weight: FloatArray) -> FloatArray:
    """Level and heights of least squares, shape (1 + n,)."""
    weighted = _weighted(columns, weight)
    normal = weighted @ weighted.T + _RIDGE * np.eye(len(columns))
    return np.asarray(np.linalg.solve(normal, weighted @ _weighted(profile, weight)), dtype=float)


def _weighted(values: FloatArray, weight: FloatArray) -> FloatArray:
    """Profiles (..., m) by weights (m,) or (m, m)."""
    out: FloatArray = values * weight if weight.ndim == 1 else values @ weight.T
    return out


def _descend(
    model: _One | _Two | _Spread,
    profile: FloatArray,
    weight: FloatArray,
    start: FloatArray,
    sharp: Sharp | None,
    rounds: int = 30,
) -> StepFit:
    count = 1 + (2 if isinstance(model, _Two) else 1)
    columns = model.columns(start)
    state = np.concatenate([_solved(columns, profile, weight), start])
    pull = np.zeros(state.size)  # weight of what is known of the blur
    known = np.zeros(state.size)
    if sharp is not None:
        pull[count + model.blur_at], known[count + model.blur_at] = sharp.deviation**-2, sharp.blur

    def residual(state: FloatArray, columns: FloatArray) -> tuple[FloatArray, float]:
        left = _weighted(state[:count] @ columns - profile, weight)
        return left, float(left @ left + pull @ (state - known) ** 2)

    left, cost = residual(state, columns)
    damping = _DAMPED
    curvature = np.eye(state.size)
    for _ in range(rounds):
        jacobian = _weighted(np.concatenate([columns, model.slopes(state[count:], state[1:count])]), weight)
        curvature = jacobian @ jacobian.T + np.diag(pull + _RIDGE)
        downhill = jacobian @ left + pull * (state - known)
        while damping < 1e6:
            step = np.linalg.solve(curvature + damping * np.diag(curvature.diagonal()), downhill)
            tried = state - step
            there = model.columns(tried[count:])
            left_there, cost_there = residual(tried, there)
            if cost_there <= cost:
                break
            damping *= 10.0
        else:
            break
        gain = cost - cost_there
        state, columns, left, cost = tried, there, left_there, cost_there
        damping = max(damping / 10.0, 1e-9)
        if gain < _ENOUGH * cost:
            break
    covariance = np.linalg.pinv(curvature)
    return StepFit(
        state[count:],
        state[1:count],
        float(np.sqrt(cost / profile.size)),
        float(np.sqrt(max(covariance[count, count], 0.0))),
    )


@lru_cache(maxsize=4)
def _grid(size: int) -> tuple[FloatArray, FloatArray]:
    """Parameters (g, 3) of shift, width and blur, and what two such steps leave of a profile, columns (g, m, 3)."""
    place = bin_places(size)
    shift, width, blur = (a.ravel() for a in np.meshgrid(_SHIFTS, _WIDTHS, _BLURS, indexing="ij"))
    outer = blurred_step(place - shift[:, None], blur[:, None])
    inner = blurred_step(place - (shift - width)[:, None], blur[:, None])
    design = np.stack([np.ones_like(outer), outer, inner], axis=1)
    return np.stack([shift, width, blur], axis=1), design


def two_starts(profile: FloatArray, weight: FloatArray, few: int = 2) -> tuple[FloatArray, float]:
    """The best places (few, 3) of two steps on a grid, and the misfit of the best."""
    parameters, design = _grid(profile.size)
    square = weight**2
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
    least = float((square * profile) @ profile - explained[order[0]])
    return parameters[picked], float(np.sqrt(max(least, 0.0) / profile.size))
