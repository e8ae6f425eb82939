"""All joints of the thesis' tests at once: weighted least squares on every printed displacement.

The thesis prints lengths, not vectors, so the fit is not linear. Nine figures are there for six joints:

1. to 6. The measured row of table 4.2. Tests 1, 2, 3, 5 and 6 are lengths of a reflector's displacement with
   every joint giving way; test 4 is the rotation of joint 4 times 0.407 m.
7. The length of test 3 after joint 2 was taken off, which table 4.1 gives back through equation 3.5.
8. The angle of test 5, which table 4.1 gives back through equation 3.29.
9. The length of test 6 after joint 1 was taken off, which table 4.1 gives back through equation 3.30.

For 7 to 9 the model does what the scripts did, with what they took off. Springs in the joints
explain the nine only badly, so the deviations are scaled up by the misfit (Birge ratio).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.loading import displacement_per_compliance, joint_torques
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis.formulas import joint5_rotation, joint_displacement
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.recovery import Recovery, recover, repeatability

FIGURES = (
    *(f"displacement, test {k}" for k in range(1, 7)),
    "length without joint 2, test 3",
    "angle, test 5",
    "length without joint 1, test 6",
)
#: Distance of the pucks between which the angle of test 5 is seen: joint 5 to flange reflector [m].
_ANGLE_BASE = 0.407


@dataclass(frozen=True, eq=False)
class ThesisFit:
    """Six springs fitted to the nine figures.

    Attributes:
        stiffness: Shape (6,) [N m/rad].
        std: Scaled by the misfit, shape (6,) [N m/rad].
        std_of_repetition: What repeating the tests alone would scatter, shape (6,) [N m/rad].
        target: The nine printed figures [m], the angle in radians, shape (9,).
        fitted: What the fitted springs give, shape (9,).
        sigma: Standard deviation of each figure, shape (9,).
        chi_square: Misfit.
        degrees_of_freedom: Three.
        side_6: +1 when the reflector of test 6 is on the side of the load's arm, -1 on the other.
    """

    stiffness: FloatArray
    std: FloatArray
    std_of_repetition: FloatArray
    target: FloatArray
    fitted: FloatArray
    sigma: FloatArray
    chi_square: float
    degrees_of_freedom: int
    side_6: int


class FigureModel:
    """The nine figures as a function of six stiffnesses."""

    def __init__(self, data: ThesisData, recovery: Recovery, side_6: int = 1) -> None:
        """Prepare the geometry; `side_6` mirrors the reflector of test 6, whose side is not printed."""
        self.data, self.recovery = data, recovery
        self.kinematics = Kinematics(data.robot)
        loadings = data.loadings(repeatability(data))
        if side_6 < 0:
            mirrored = loadings.reflector.copy()
            mirrored[5, 1] *= -1.0
            loadings = replace(loadings, reflector=mirrored)
        self.A = displacement_per_compliance(self.kinematics, loadings)  # (6 tests, 3, 6)
        self.torque = joint_torques(self.kinematics, loadings)
        self.taken_off_3 = _joint2_of_a10(self.kinematics, data, recovery)
        self.taken_off_6 = joint1_of_a13(self.kinematics, data, recovery)
        self._pucks = self._puck_geometry()

    def target(self) -> FloatArray:
        """The printed figures, shape (9,)."""
        k, tests = self.recovery.stiffness, self.data.tests
        three, five, six = tests[2], tests[4], tests[5]
        lever_3 = float(np.hypot(1.142 - 0.088, 0.207))
        return np.array(
            [
                *(test.measured for test in tests),
                abs(three.wrench_flange[2]) * three.load_arm * lever_3 / k[2],  # (3.5)
                five.wrench_flange[0] * five.load_arm / k[4],  # (3.29)
                abs(six.wrench_flange[5]) * six.extra["radius"] / k[5],  # (3.30)
            ]
        )

    def sigma(self) -> FloatArray:
        """Their standard deviations, shape (9,)."""
        one = repeatability(self.data)
        sigma = np.full(9, one)
        sigma[7] = np.sqrt(2.0) * one / _ANGLE_BASE
        return sigma

    def predict(self, stiffness: FloatArray) -> FloatArray:
        """The nine figures, shape (9,) [m, rad], of a robot with this stiffness, shape (6,) [N m/rad]."""
        d = self.A @ (1.0 / stiffness)  # (6, 3)
        lengths = np.linalg.norm(d, axis=1)
        lengths[3] = abs(self.torque[3, 3]) / stiffness[3] * self.data.test(4).extra["radius"]
        return np.array(
            [
                *lengths,
                np.linalg.norm(d[2] - self.taken_off_3),
                self._angle_5(stiffness),
                np.linalg.norm(d[5] - self.taken_off_6),
            ]
        )

    def _puck_geometry(self) -> list[tuple[FloatArray, FloatArray]]:
        """Joint 2, joint 5 and the flange reflector in test 5: position and displacement per compliance."""
        test = self.data.test(5)
        pucks = []
        for link, position in ((1, np.zeros(3)), (4, np.zeros(3)), (test.reflector_link, test.reflector)):
            frame = self.kinematics.link_frames(test.q)[link]
            J = self.kinematics.link_jacobian(test.q, link, position)[:3]
            pucks.append((frame[:3, :3] @ position + frame[:3, 3], J * self.torque[4]))
        return pucks

    def _angle_5(self, stiffness: FloatArray) -> float:
        (a, A), (b, B), (c, C) = self._pucks
        moved = 1.0 / stiffness
        return abs(joint5_rotation((a, b, c), (a + A @ moved, b + B @ moved, c + C @ moved)))


def overall_std(recovery: Recovery, fit: ThesisFit) -> FloatArray:
    """Standard deviation to use with the thesis' stiffness, shape (6,) [N m/rad].

    What a repetition would scatter, and the distance between the thesis' one-by-one identification and the
    fit of all joints: two readings of the same tests ought not to differ by more than their deviation.
    """
    return np.hypot(fit.std_of_repetition, fit.stiffness - recovery.stiffness)


def fit_thesis(data: ThesisData) -> ThesisFit:
    """Fit six springs to the nine figures; the side of test 6's reflector that fits better is taken."""
    recovery = recover(data)
    fits = [_fit(data, recovery, side) for side in (1, -1)]
    return min(fits, key=lambda fit: fit.chi_square)


def _fit(data: ThesisData, recovery: Recovery, side: int) -> ThesisFit:
    model = FigureModel(data, recovery, side)
    target, sigma = model.target(), model.sigma()
    start = np.log(recovery.stiffness)
    # Several starts: the length of a vector has its minimum where the joints cancel.
    rng = np.random.default_rng(0)
    starts = [start, *(start + rng.normal(scale=0.7, size=(15, JOINTS)))]
    found = [
        least_squares(lambda x: (model.predict(np.exp(x)) - target) / sigma, x0, x_scale=0.1) for x0 in starts
    ]
    best = min(found, key=lambda result: result.cost)
    stiffness = np.exp(best.x)
    chi_square, dof = float(2.0 * best.cost), len(target) - JOINTS
    relative = np.sqrt(np.diag(np.linalg.inv(best.jac.T @ best.jac)))
    return ThesisFit(
        stiffness=stiffness,
        std=stiffness * relative * np.sqrt(max(1.0, chi_square / dof)),
        std_of_repetition=stiffness * relative,
        target=target,
        fitted=model.predict(stiffness),
        sigma=sigma,
        chi_square=chi_square,
        degrees_of_freedom=dof,
        side_6=side,
    )


def _joint2_of_a10(kinematics: Kinematics, data: ThesisData, recovery: Recovery) -> FloatArray:
    """What A.10 takes off, shape (3,) [m]: joint 2 at the load point under [0 0 -Fz 0 0 0]."""
    test = data.test(3)
    J = kinematics.jacobian(test.q, (0.0, 0.0, data.tool_z))
    wrench = np.array([0.0, 0.0, -test.wrench_flange[2], 0.0, 0.0, 0.0])
    return joint_displacement(J, wrench, 2, recovery.stiffness[1])


def joint1_of_a13(kinematics: Kinematics, data: ThesisData, recovery: Recovery) -> FloatArray:
    """What A.13 takes off, shape (3,) [m]: joint 1 under readings in flange axes times a Jacobian in base axes."""
    test = data.test(6)
    J = kinematics.jacobian(test.q, (0.0, 0.0, data.tool_z))
    return joint_displacement(J, test.wrench_flange, 1, recovery.stiffness[0])
