"""Every loading test of the thesis predicted with all joints giving way, beside its own two columns."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.loading import displacement_per_compliance, joint_torques
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.recovery import Recovery, repeatability

#: Why ours, the thesis' simulation and its measurement differ, test by test.
CAUSES = (
    "one joint only: the stiffness was computed from this very displacement, so agreement is arithmetic",
    "one joint only, as test 1; the load is the 197 N of the weight, not a reading",
    "the simulation moves as joint 3 alone does, the measured column holds joint 2 as well",
    "the column is the rotation of joint 4 times 0.407 m; 0.0002677 rad follows from no printed stiffness",
    "joints 2 and 3 move the reflector more than joint 5 does; the script's angle holds part of joint 3",
    "joint 5 bends under the same rope and was not taken off; its share is larger than the deviation",
)


@dataclass(frozen=True, eq=False)
class TestComparison:
    """One row of table 4.2, extended.

    Attributes:
        joint: The joint under test.
        measured: Table 4.2 [m].
        simulated: Table 4.2 [m].
        simulated_components: Appendix, axes of the thesis' simulation, shape (3,) [m]; None for joint 4.
        predicted: All joints giving way [m]; for test 4 rotation of joint 4 times 0.407 m.
        predicted_vector: Displacement with all joints giving way, base axes, shape (3,) [m].
        own_joint: Length with only the joint under test giving way [m].
        by_joint: Length that each joint alone would give, shape (6,) [m].
        predicted_std: Standard deviation of `predicted` from that of the stiffness [m].
        nearest_joints: The set of joints which, giving way together, comes nearest to `simulated`.
        nearest: The length they give [m].
        cause: Why the columns differ.
    """

    joint: int
    measured: float
    simulated: float
    simulated_components: FloatArray | None
    predicted: float
    predicted_vector: FloatArray
    own_joint: float
    by_joint: FloatArray
    predicted_std: float
    nearest_joints: tuple[int, ...]
    nearest: float
    cause: str


def compare_with_simulation(
    data: ThesisData, recovery: Recovery, stiffness_std: FloatArray, side_6: int = 1
) -> list[TestComparison]:
    """Predict the six tests with the recovered stiffness.

    Args:
        data: The tests.
        recovery: Their stiffness.
        stiffness_std: Its standard deviation, shape (6,) [N m/rad].
        side_6: Side of the reflector of test 6, which is not printed: +1 that of the load's arm.
    """
    kinematics = Kinematics(data.robot)
    loadings = data.loadings(repeatability(data))
    if side_6 < 0:
        loadings.reflector[5, 1] *= -1.0
    A = displacement_per_compliance(kinematics, loadings)  # (6, 3, 6)
    compliance = 1.0 / recovery.stiffness
    compliance_std = stiffness_std / recovery.stiffness**2
    torque = joint_torques(kinematics, loadings)
    rows = []
    for i, test in enumerate(data.tests):
        vector = A[i] @ compliance
        by_joint = np.linalg.norm(A[i], axis=0) * compliance
        length = float(np.linalg.norm(vector))
        gradient = vector / length @ A[i]
        own = by_joint[i]
        if test.joint == 4:
            own = length = abs(torque[i, 3]) * compliance[3] * test.extra["radius"]
            gradient = np.zeros(6)
            gradient[3] = abs(torque[i, 3]) * test.extra["radius"]
        joints, nearest = _nearest_joints(A[i] * compliance, test.simulated)
        if test.joint == 4:
            joints, nearest = (4,), float(own)
        rows.append(
            TestComparison(
                joint=test.joint,
                measured=test.measured,
                simulated=test.simulated,
                simulated_components=None
                if np.isnan(test.simulated_components).any()
                else test.simulated_components,
                predicted=float(length),
                predicted_vector=vector,
                own_joint=float(own),
                by_joint=by_joint,
                predicted_std=float(np.linalg.norm(gradient * compliance_std)),
                nearest_joints=joints,
                nearest=nearest,
                cause=CAUSES[i],
            )
        )
    return rows


def _nearest_joints(by_joint: FloatArray, length: float) -> tuple[tuple[int, ...], float]:
    """Joints (1..6) whose displacements, columns of (3, 6), add up to the length nearest to a given one.

    Joints that move the reflector by less than a hundredth of the length are left out of the search.
    """
    matter = np.flatnonzero(np.linalg.norm(by_joint, axis=0) > 0.01 * length)
    sets = [s for n in range(1, len(matter) + 1) for s in itertools.combinations(matter, n)]
    lengths = [float(np.linalg.norm(by_joint[:, list(s)].sum(axis=1))) for s in sets]
    best = int(np.argmin(np.abs(np.array(lengths) - length)))
    return tuple(int(j) + 1 for j in sets[best]), lengths[best]
