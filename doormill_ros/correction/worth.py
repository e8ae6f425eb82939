"""How much of a predicted deflection a correction is worth, when springs and forces are known only so well.

The deflection of n loads is a sum over springs, each of which is off by its standard deviation, and is linear in the
force, each component of which is off by its own. To first order the deflection has the variance

    sum over joints |J_j tau_j / K_j|^2 (s_j / K_j)^2 + |J_j|^2 g_j^2  +  sum over components |A e_i s_i|^2,

with A = J K^-1 J^T and g_j the standard deviation of a gap that was measured.

A prediction d with the spread s is best corrected by the share 1 / (1 + (s / d)^2) of itself: of all shares of a figure
that is off by s, this one leaves the smallest mean square. Where nobody measured the force its standard deviation is a
guess too. There the correction moves the tool by no more than a bound, without turning it, so that it shifts a wall by
no more than that bound whatever the truth.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.correction.felt import knowing
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel, StandingSpread

#: Standard deviation of a spring of which the robot's description states none, as a share of it; assumed
UNSTATED = 0.3


@dataclass(frozen=True, eq=False)
class DeflectionSpread:
    """What is left to chance of the displacement of n loaded tools.

    Attributes:
        joints: By spring and gap of each joint, shape (n, 6) [m].
        force: By the force, shape (n,) [m].
        weights: By the masses that the arm sags under, shape (n,) [m].
    """

    joints: FloatArray
    force: FloatArray
    weights: FloatArray

    @property
    def total(self) -> FloatArray:
        """Standard deviation of the displacement's length, shape (n,) [m]."""
        variance: FloatArray = np.sum(self.joints**2, axis=1) + self.force**2 + self.weights**2
        return np.sqrt(variance)


@dataclass(frozen=True, eq=False)
class Worth:
    """Which share of a predicted deflection is corrected.

    Attributes:
        kinematics: Of the robot.
        stiffness: Joint springs, shape (6,) [N m/rad].
        relative: Standard deviation of each as a share of it, shape (6,).
        bound: Largest correction where nobody measured the force [m].
        gap: Standard deviation of the gap of each joint, 0 where none was measured, shape (6,) [rad].
    """

    kinematics: Kinematics
    stiffness: FloatArray
    relative: FloatArray
    bound: float
    gap: FloatArray = field(default_factory=lambda: np.zeros(6))

    def spread(
        self,
        q: FloatArray,
        wrench: FloatArray,
        components: FloatArray,
        load_point: FloatArray,
        standing: StandingSpread | None = None,
    ) -> DeflectionSpread:
        """First-order spread of the displacement of the load point.

        Args:
            q: Joint angles, shape (n, 6) [rad].
            wrench: At the load point, base axes, shape (n, 6) [N, N m].
            components: Standard deviations of the wrench as independent wrenches, base axes, shape (n, 6, 6) [N, N m].
            load_point: In the flange frame, shape (3,) [m].
            standing: Of the unloaded tool, whose springs are the same; None for a force by itself.
        """
        J = self.kinematics.jacobian(q, load_point)  # (n, 6, 6)
        turn = np.einsum("nij,ni->nj", J, wrench) / self.stiffness  # (n, 6) [rad]
        by_spring = np.einsum("nij,nj->nji", J[:, :3], turn * self.relative)  # (n, 6 joints, 3) [m]
        if standing is not None:
            by_spring = by_spring + standing.joints
        by_joint = np.sqrt(np.einsum("nji,nji->nj", by_spring, by_spring))
        if self.gap.any():
            by_joint = np.hypot(by_joint, np.linalg.norm(J[:, :3], axis=1) * self.gap)  # (n, 6)
        turns = components @ J / self.stiffness  # (n, 6 components, 6 joints)
        moved = turns @ np.swapaxes(J[:, :3], 1, 2)  # (n, 6 components, 3) [m]
        rest = np.zeros(len(q)) if standing is None else standing.rest
        return DeflectionSpread(by_joint, np.sqrt(np.sum(moved**2, axis=(1, 2))), rest)

    def share(self, deflection: FloatArray, spread: DeflectionSpread, bounded: BoolArray) -> FloatArray:
        """Share of the deflection's six components that is corrected, shape (n, 6).

        Args:
            deflection: Predicted twists, shape (n, 6) [m, rad].
            spread: Of their displacements.
            bounded: Where nobody measured the force, shape (n,).
        """
        size = _size(deflection)
        share = 1.0 / (1.0 + (spread.total / size) ** 2)
        share = np.where(bounded, np.minimum(share, self.bound / size), share)
        turn = np.where(bounded, 0.0, share)
        return np.concatenate(
            [np.repeat(share[:, None], 3, axis=1), np.repeat(turn[:, None], 3, axis=1)], axis=1
        )


def standing_share(standing: FloatArray, spread: StandingSpread) -> FloatArray:
    """Share of the twists of unloaded tools that is corrected, shape (n,).

    They are there whatever is milled, so no bound holds for them.

    Args:
        standing: Predicted twists, shape (n, 6) [m, rad].
        spread: Of their displacements.
    """
    variance = np.sum(spread.joints**2, axis=(1, 2)) + spread.rest**2
    share: FloatArray = 1.0 / (1.0 + variance / _size(standing) ** 2)
    return share


def _size(twist: FloatArray) -> FloatArray:
    size: FloatArray = np.maximum(np.linalg.norm(twist[:, :3], axis=1), 1e-12)
    return size


def worth_of(robot: Robot, bound: float, model: ComplianceModel | None = None) -> Worth:
    """The worth of corrections of a robot.

    Args:
        robot: Springs and their standard deviations.
        bound: Largest correction where nobody measured the force [m].
        model: That corrects: what it measured of springs and gaps takes the place of the robot's figures.
    """
    unstated = np.full_like(robot.stiffness, UNSTATED)
    share = unstated if robot.stiffness_std is None else robot.stiffness_std / robot.stiffness
    share = np.where(np.isnan(share), unstated, share)
    knower = None if model is None else knowing(model)
    if knower is None:
        return Worth(Kinematics(robot), robot.stiffness, share, bound)
    known = knower.knowledge()
    measured = known.stiffness_std / known.stiffness
    share = np.where(np.isnan(measured), share, measured)
    return Worth(Kinematics(robot), known.stiffness, share, bound, known.gap_std)
