"""Weighted least squares over the six degrees of freedom of a door."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, cholesky, solve_triangular
from scipy.special import chdtrc, chdtri

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import apply_twist
from doormill_ros.localization.sensors.errors import Contradiction, NotConverged, Undetermined
from doormill_ros.localization.sensors.sensor import CONTRADICTION

# A rotation of 1 rad is put beside a translation of this length when conditions are judged [m].
_LEVER = 1.0
_MAX_CONDITION = 1.0e6
_STEP_DONE = 1.0e-10
_MAX_STEPS = 30


@dataclass(frozen=True, eq=False)
class Linearised:
    """Readings against a pose.

    Attributes:
        residual: Measured minus predicted, shape (n,).
        jacobian: Derivative of the prediction by a twist of the door (`frames.apply_twist`), shape (n, 6).
        covariance: Of the readings, shape (n, n) or variances, shape (n,).
    """

    residual: FloatArray
    jacobian: FloatArray
    covariance: FloatArray


@dataclass(frozen=True, eq=False)
class PoseFit:
    """Outcome of `fit_pose`; covariance of the twist from the estimate to the truth, shape (6, 6)."""

    T_base_door: FloatArray
    covariance: FloatArray
    chi_square: float
    redundancy: int


def fit_pose(T_start: FloatArray, linearise: Callable[[FloatArray], Linearised], what: str) -> PoseFit:
    """As `solve_pose`, and the readings are held against each other.

    Raises:
        Undetermined: A degree of freedom is left open.
        NotConverged: The steps do not vanish.
        Contradiction: There are more readings than needed and they do not fit together.
    """
    fit = solve_pose(T_start, linearise, what)
    check_agreement(fit, what)
    return fit


def solve_pose(T_start: FloatArray, linearise: Callable[[FloatArray], Linearised], what: str) -> PoseFit:
    """Gauss-Newton from `T_start` (4, 4).

    Args:
        T_start: First guess of T_base_door.
        linearise: The readings against a pose.
        what: The readings in words, for messages.

    Raises:
        Undetermined: A degree of freedom is left open.
        NotConverged: The steps do not vanish.
    """
    T_base_door = np.array(T_start, dtype=float)
    for _ in range(_MAX_STEPS):
        model = linearise(T_base_door)
        residual, jacobian = whiten(model)
        check_rank(jacobian, what)
        step = np.asarray(np.linalg.lstsq(jacobian, residual, rcond=None)[0], dtype=float)
        T_base_door = apply_twist(T_base_door, step)
        if not np.all(np.isfinite(step)) or np.abs(step).max() > 1.0:
            break
        if np.abs(step).max() < _STEP_DONE:
            return _finish(T_base_door, *whiten(linearise(T_base_door)))
    raise NotConverged(f"no door pose explains the {what} after {_MAX_STEPS} steps; measure again")


def whiten(model: Linearised) -> tuple[FloatArray, FloatArray]:
    """Residual (n,) and Jacobian (n, 6) in units of standard deviations."""
    if model.covariance.ndim == 1:
        scale = 1.0 / np.sqrt(model.covariance)
        return model.residual * scale, model.jacobian * scale[:, None]
    try:
        root = cholesky(model.covariance, lower=True)
    except LinAlgError as error:
        raise Undetermined(
            "the covariance of the readings is not positive; correct the sensor's file"
        ) from error
    both = solve_triangular(root, np.column_stack([model.residual, model.jacobian]), lower=True)
    return both[:, 0], both[:, 1:]


def check_rank(jacobian: FloatArray, what: str) -> None:
    """Refuse a Jacobian, shape (n, 6), that leaves a twist open.

    Raises:
        Undetermined: Fewer readings than degrees of freedom, or all blind for the same twist.
    """
    scaled = jacobian / np.array([1.0, 1.0, 1.0, _LEVER, _LEVER, _LEVER])
    values = np.linalg.svd(scaled, compute_uv=False)
    if jacobian.shape[0] < 6 or values[-1] * _MAX_CONDITION < values[0]:
        raise Undetermined(
            f"{jacobian.shape[0]} {what} leave a degree of freedom of the door open, six that differ are "
            "needed; add or move a reading"
        )


def check_agreement(fit: PoseFit, what: str) -> None:
    """Refuse readings that do not fit together.

    Raises:
        Contradiction: There are more than needed, and their chi-square is beyond chance.
    """
    chi_square, redundancy = fit.chi_square, fit.redundancy
    if redundancy > 0 and chdtrc(redundancy, chi_square) < CONTRADICTION:
        raise Contradiction(
            f"the {what} contradict each other: chi-square is {chi_square:.1f} with {redundancy} degrees of "
            f"freedom, allowed is {chdtri(redundancy, CONTRADICTION):.1f}; clean the door and measure again",
            chi_square=chi_square,
        )


def _finish(T_base_door: FloatArray, residual: FloatArray, jacobian: FloatArray) -> PoseFit:
    covariance = cho_solve(cho_factor(jacobian.T @ jacobian), np.eye(6))
    return PoseFit(
        T_base_door, (covariance + covariance.T) / 2.0, float(residual @ residual), residual.size - 6
    )
