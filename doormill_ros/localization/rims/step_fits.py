"""Fits of one step, of two, and of one seen by a defocused lens to the mean profile of an edge.

Levenberg's and Marquardt's descent with derivatives in closed form; levels and heights are parameters as places are.
Weights are those of bins by themselves, shape (m,), or what makes errors that go together white, shape (m, m).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from scipy.linalg.lapack import dposv

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.edge_points.step_grid import RIDGE
from doormill_ros.localization.edge_points.step_models import (
    DISC,
    RAMP,
    OneStep,
    RoundedStep,
    SpreadStep,
    TwoSteps,
)

_ENOUGH = 1.0e-5  # a fit ends where its squares fall by less, as a share
_DAMPED = 1.0e-3


@dataclass(frozen=True, eq=False)
class StepFit:
    """A fit.

    Attributes:
        places: Shift of the outer step [px], and what else the model has; see `fit_one`, `fit_disc` and `fit_two`.
        heights: Of the steps as shares of the edge's, shape (1,) or (2,).
        misfit: RMS of the weighted residuals, what is known of the blur among them.
        covariance: Of the places where the weights are those of the errors, shape (k, k); infinite where it is open.
    """

    places: FloatArray
    heights: FloatArray
    misfit: float
    covariance: FloatArray

    @property
    def deviation(self) -> float:
        """Standard deviation of the shift where the weights are those of the errors [px]."""
        return sqrt(max(float(self.covariance[0, 0]), 0.0))


def fit_one(profile: FloatArray, weight: FloatArray, blur: float, sharp: Sharp | None = None) -> StepFit:
    """One step in a profile (m,) of weights (m,); places are shift and blur [px], which starts from `blur`."""
    return _descend(OneStep(profile.size), profile, weight, np.array([0.0, blur]), sharp)


def fit_disc(profile: FloatArray, weight: FloatArray, radius: float) -> StepFit:
    """One step of a profile (m,), weights (m,), spread by a disc; places are shift and radius from `radius` [px]."""
    return _descend(SpreadStep(profile.size, DISC, 2), profile, weight, np.array([0.0, radius]), None)


def fit_soft_disc(profile: FloatArray, weight: FloatArray, radius: float, blur: float) -> StepFit:
    """One step of a profile (m,), weights (m,), spread by a disc and a lens; places are shift, radius, blur [px]."""
    return _descend(SpreadStep(profile.size, DISC, 3), profile, weight, np.array([0.0, radius, blur]), None)


def fit_ramp(profile: FloatArray, weight: FloatArray, reach: float, blur: float) -> StepFit:
    """An edge that thins out evenly, profile and weights (m,); places: shift, half width from `reach`, blur [px]."""
    return _descend(SpreadStep(profile.size, RAMP, 3), profile, weight, np.array([0.0, reach, blur]), None)


def fit_two(
    profile: FloatArray, weight: FloatArray, start: FloatArray, sharp: Sharp | None = None
) -> StepFit:
    """Two steps, profile and weights (m,); places: the outer's shift, how far inside the inner is, blur (3,) [px]."""
    return _descend(TwoSteps(profile.size), profile, weight, start, sharp)


def fit_rounded(
    profile: FloatArray, weight: FloatArray, start: FloatArray, left: float, known: Known | None = None
) -> StepFit:
    """A slope with `left` of the step at its end, profile and weights (m,); places: end, width, blur (3,) [px]."""
    return _descend(RoundedStep(profile.size, left), profile, weight, start, known)


@dataclass(frozen=True)
class Sharp:
    """A blur that is known beforehand, and its standard deviation [px]."""

    blur: float
    deviation: float

    def among(self, count: int, at: int) -> Known:
        """What is known of `count` places of which that one is the blur."""
        places, precision = np.zeros(count), np.zeros((count, count))
        places[at], precision[at, at] = self.blur, self.deviation**-2
        return Known(places, precision)


@dataclass(frozen=True, eq=False)
class Known:
    """What is known beforehand of the places of a fit.

    Attributes:
        places: What they are, shape (k,) [px].
        precision: Inverse of their covariance, zero for what is not known, shape (k, k) [1/px^2].
    """

    places: FloatArray
    precision: FloatArray


def _weighted(values: FloatArray, weight: FloatArray) -> FloatArray:
    """Profiles (..., m) by weights (m,) or (m, m)."""
    # Of arrays as small as these the method asks less of NumPy than the operator does.
    out: FloatArray = values * weight if weight.ndim == 1 else values.dot(weight.T)
    return out


def _solved(normal: FloatArray, right: FloatArray) -> FloatArray | None:
    """Solution (k,) of a normal equation, matrix (k, k); None where that is not positive definite."""
    _, found, fault = dposv(normal, right)
    return None if fault else found


def _descend(
    model: OneStep | TwoSteps | SpreadStep | RoundedStep,
    profile: FloatArray,
    weight: FloatArray,
    start: FloatArray,
    known: Sharp | Known | None,
    rounds: int = 30,
) -> StepFit:
    count, size = model.count, model.count + len(start)
    white = _weighted(profile, weight)
    columns = _weighted(model.at(start.tolist()), weight)
    normal = columns.dot(columns.T)
    normal.flat[:: count + 1] += RIDGE
    state = np.concatenate([np.linalg.solve(normal, columns.dot(white)), start])
    if isinstance(known, Sharp):
        known = known.among(len(start), model.blur_at)
    left = _weighted(state[:count].dot(model.columns) - profile, weight)
    cost = float(left.dot(left))
    if known is not None:
        off = state[count:] - known.places
        pull = known.precision.dot(off)
        cost += float(off.dot(pull))
    damping = _DAMPED
    damped = np.empty((size, size))
    own_damped = damped.reshape(-1)[:: size + 1]
    curvature = np.eye(size)
    for _ in range(rounds):
        jacobian = _weighted(model.slopes(state[1:count].tolist()), weight)
        curvature = jacobian.dot(jacobian.T)
        own = curvature.reshape(-1)[:: size + 1]
        own += RIDGE
        downhill = jacobian.dot(left)
        if known is not None:
            curvature[count:, count:] += known.precision
            downhill[count:] += pull
        while damping < 1e6:
            damped[:] = curvature
            own_damped *= 1.0 + damping
            step = _solved(damped, downhill)
            if step is not None:
                tried = state - step
                left_there = tried[:count].dot(model.at(tried[count:].tolist()))
                left_there -= profile
                left_there = _weighted(left_there, weight)
                cost_there = float(left_there.dot(left_there))
                if known is not None:
                    off = tried[count:] - known.places
                    pull_there = known.precision.dot(off)
                    cost_there += float(off.dot(pull_there))
                if cost_there <= cost:
                    break
            damping *= 10.0
        else:
            break
        gain = cost - cost_there
        state, left, cost = tried, left_there, cost_there
        if known is not None:
            pull = pull_there
        damping = max(damping / 10.0, 1e-9)
        if gain < _ENOUGH * cost:
            break
    by_places = _solved(curvature, np.eye(size)[:, count:])
    covariance = np.full((len(start), len(start)), inf) if by_places is None else by_places[count:]
    return StepFit(state[count:], state[1:count], sqrt(cost / profile.size), covariance)
