"""All joints at once: weighted least squares of the compliances, with standard deviations.

The model d = A c (see `loading`) is linear in the compliances c = 1 / K. Two things scatter: the
displacement, and the wrench from which A is computed. The wrench's share of a residual's variance depends on
c itself, so the fit is repeated with the weights of the last c (effective variance method) until it stands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.measurements.errors import IdentifiabilityError
from doormill_ros.measurements.loading import (
    Loadings,
    displacement_per_compliance,
    joint_torques,
    load_jacobian,
    reflector_jacobian,
)
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.statistics import root_mean_square

#: A joint counts as identified when its compliance is known better than to this share.
WORST_RELATIVE_STD = 0.5
_MAX_ROUNDS = 30
_UNTOLD = 1e6  # how much worse than the best told a direction without information counts


@dataclass(frozen=True, eq=False)
class StiffnessFit:
    """Outcome of a weighted fit; what the loadings do not tell is NaN.

    Attributes:
        stiffness: Joint stiffness, shape (6,) [N m/rad].
        std: Its standard deviation, shape (6,) [N m/rad].
        compliance: 1 / stiffness, shape (6,) [rad/(N m)].
        compliance_covariance: Shape (6, 6); NaN where a joint is not identified.
        residual: Measured minus predicted displacement, shape (n, 3) [m].
        rmse: Root mean square of the residual [m].
        chi_square: Sum of squared residuals over their variance.
        degrees_of_freedom: Displacement components minus fitted compliances.
        rounds: Reweighted fits that were needed.
    """

    stiffness: FloatArray
    std: FloatArray
    compliance: FloatArray
    compliance_covariance: FloatArray
    residual: FloatArray
    rmse: float
    chi_square: float
    degrees_of_freedom: int
    rounds: int

    @property
    def identified(self) -> FloatArray:
        """Which joints the loadings tell, shape (6,) bool."""
        return np.isfinite(self.stiffness)


def fit_stiffness(kinematics: Kinematics, loadings: Loadings) -> StiffnessFit:
    """Fit the six joint stiffnesses to measured displacements.

    A joint that no loading turns, that cannot be told from others, or whose compliance comes out
    less certain than `WORST_RELATIVE_STD` (or negative) is NaN in the result.

    Raises:
        IdentifiabilityError: No joint is left.
    """
    A, gain = _design(kinematics, loadings)
    return _fit_columns(A, gain, loadings)


def fit_by_preload(kinematics: Kinematics, loadings: Loadings, direction: FloatArray) -> StiffnessFit:
    """Stiffness of each joint when pre-loaded and when not (thesis section 3.3, table 4.3).

    A joint is pre-loaded when its last motion went against the direction in which the load turns it; then its
    gears touch on the side that carries the load. A joint of unknown motion counts as pre-loaded.

    Args:
        kinematics: Of the robot that was loaded.
        loadings: The trials.
        direction: Last motion of each joint, -1, 0 (unknown) or +1, shape (n, 6).

    Returns:
        A fit of twelve stiffnesses: first the six pre-loaded joints, then the six that are not.

    Raises:
        IdentifiabilityError: No joint is told.
    """
    A, gain = _design(kinematics, loadings)
    slack = np.asarray(direction) * joint_torques(kinematics, loadings) > 0.0  # (n, 6)
    split = np.concatenate([~slack, slack], axis=1)  # (n, 12)
    A = np.concatenate([A, A], axis=2) * split[:, None]
    gain = np.concatenate([gain, gain], axis=3) * split[:, None, None]
    return _fit_columns(A, gain, loadings)


def _design(kinematics: Kinematics, loadings: Loadings) -> tuple[FloatArray, FloatArray]:
    """Displacement per compliance (n, 3, 6), and per wrench component and compliance (n, 3, 6, 6)."""
    A = displacement_per_compliance(kinematics, loadings)
    lever = reflector_jacobian(kinematics, loadings)[:, :3]
    return A, np.einsum("nik,nwk->niwk", lever, load_jacobian(kinematics, loadings))


def _fit_columns(A: FloatArray, gain: FloatArray, loadings: Loadings) -> StiffnessFit:
    """Fit every compliance that moves a reflector, and report those that come out certain enough.

    The others stay in the fit: leaving a joint out would call it rigid and push its share onto the rest.
    """
    joints = np.flatnonzero(np.linalg.norm(A.reshape(-1, A.shape[2]), axis=0) > 0.0)
    if joints.size:
        fit = _report(A, loadings, joints, *_reweighted(A, gain, loadings, joints))
        if fit.identified.any():
            return fit
    raise IdentifiabilityError(
        f"{len(loadings)} loadings tell the stiffness of no joint to better than "
        f"{WORST_RELATIVE_STD:.0%}; load the joints harder or in more configurations"
    )


def _reweighted(
    A: FloatArray, gain: FloatArray, loadings: Loadings, joints: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray, int, int]:
    """Compliances of the joints, their covariance, 1 / deviation of each component, rank and rounds."""
    design = A[:, :, joints].reshape(-1, joints.size)
    target = loadings.displacement.reshape(-1)
    inverse_std = 1.0 / loadings.displacement_std.reshape(-1)
    last = np.full(joints.size, np.inf)
    rounds = 0
    while rounds < _MAX_ROUNDS:
        rounds += 1
        compliance, covariance, rank = _solve(design * inverse_std[:, None], target * inverse_std)
        from_wrench = gain[..., joints] @ compliance * loadings.wrench_std[:, None]  # (n, 3, 6 wrench)
        variance = loadings.displacement_std**2 + (from_wrench**2).sum(axis=-1)
        inverse_std = 1.0 / np.sqrt(variance.reshape(-1))
        if np.all(np.abs(compliance - last) <= 1e-10 * np.abs(compliance)):
            break
        last = compliance
    return compliance, covariance, inverse_std, rank, rounds


def _solve(design: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray, int]:
    """Least squares with columns scaled to one, since compliances differ by a factor of 50.

    Returns:
        Solution, covariance and rank.
    """
    scale = np.linalg.norm(design, axis=0)
    # All of V also where there are fewer equations than joints; never the square U of many equations.
    _, s, vt = np.linalg.svd(design / scale, full_matrices=len(design) < design.shape[1])
    rank = int(np.sum(s > s[0] * 1e-10))
    v = vt[:rank].T
    solution = v @ ((v.T @ (design / scale).T @ target) / s[:rank] ** 2) / scale
    half = v / s[:rank]
    # A direction without information has infinite variance, not none; a huge one keeps the arithmetic finite.
    nothing = vt[rank:].T * _UNTOLD / s[0]
    covariance = half @ half.T + nothing @ nothing.T
    return solution, covariance / np.outer(scale, scale), rank


def _report(
    A: FloatArray,
    loadings: Loadings,
    joints: IntArray,
    found: FloatArray,
    covariance: FloatArray,
    inverse_std: FloatArray,
    rank: int,
    rounds: int,
) -> StiffnessFit:
    columns = A.shape[2]
    told = (found > 0.0) & (np.sqrt(np.diag(covariance)) <= WORST_RELATIVE_STD * np.abs(found))
    compliance = np.full(columns, np.nan)
    compliance[joints[told]] = found[told]
    full = np.full((columns, columns), np.nan)
    full[np.ix_(joints[told], joints[told])] = covariance[told][:, told]
    residual = loadings.displacement - A[:, :, joints] @ found
    return StiffnessFit(
        stiffness=1.0 / compliance,
        std=np.sqrt(np.diag(full)) / compliance**2,
        compliance=compliance,
        compliance_covariance=full,
        residual=residual,
        rmse=root_mean_square(residual),
        chi_square=float(np.sum((residual.reshape(-1) * inverse_std) ** 2)),
        degrees_of_freedom=int(residual.size - rank),
        rounds=rounds,
    )
