"""The robot under load along a plan: which joints bend, which way they turn, what that does to the tool."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.correction.compensate import Compensation, compensate
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel


@dataclass(frozen=True, eq=False)
class LoadedRobot:
    """A robot that gives way under load, with its tool.

    Attributes:
        kinematics: Forward kinematics and Jacobian.
        model: How the robot gives way.
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
        tolerance: Accepted distance of the loaded tool from the nominal pose [m].
    """

    kinematics: Kinematics
    model: ComplianceModel
    T_flange_tool: FloatArray
    tolerance: float = 1e-6

    @property
    def load_point(self) -> FloatArray:
        """Tool centre point in the flange frame, shape (3,) [m]."""
        return self.T_flange_tool[:3, 3]

    def deflection(self, q: FloatArray, wrench: FloatArray, direction: FloatArray) -> FloatArray:
        """Twist of the loaded tool, base axes; shapes (n, 6) each [rad], [N, N m], [-] -> [m, rad]."""
        return self.model.deflection(q, wrench, self.load_point, direction)

    def posture(self, T_base_tool: FloatArray, q: FloatArray) -> FloatArray:
        """Joint angles that reach nominal poses unloaded, from angles near them.

        Args:
            T_base_tool: Poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].

        Returns:
            Shape (n, 6) [rad].
        """
        unloaded = np.zeros((len(q), 6))
        found = compensate(T_base_tool, q, lambda _: unloaded, self.kinematics, self.T_flange_tool, 1e-9)
        return found.q

    def corrected(
        self, T_base_tool: FloatArray, q: FloatArray, wrench: FloatArray, direction: FloatArray
    ) -> Compensation:
        """Corrected poses of n stations, each under one load.

        Args:
            T_base_tool: Nominal poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].
            wrench: At the tool centre point, base axes, shape (n, 6) [N, N m].
            direction: Direction of each joint's motion, shape (n, 6).
        """
        deflect = lambda angles: self.deflection(angles, wrench, direction)  # noqa: E731
        return compensate(T_base_tool, q, deflect, self.kinematics, self.T_flange_tool, self.tolerance)

    def corrected_for_all(
        self,
        T_base_tool: FloatArray,
        q: FloatArray,
        owner: IntArray,
        wrench: FloatArray,
        direction: FloatArray,
    ) -> Compensation:
        """Corrected poses of n targets, each for the mean of the deflections under its loads.

        A target between two motions has one pose, but a load from either side; in the mean of
        the two the larger of the errors that remain is smallest.

        Args:
            T_base_tool: Nominal poses, shape (n, 4, 4).
            q: Joint angles near them, shape (n, 6) [rad].
            owner: Target to which each load belongs, every target at least once, shape (e,).
            wrench: Loads, shape (e, 6) [N, N m].
            direction: Direction of each joint's motion under each load, shape (e, 6).
        """
        share = 1.0 / np.bincount(owner, minlength=len(q))[owner]

        def deflect(angles: FloatArray) -> FloatArray:
            each = self.deflection(angles[owner], wrench, direction) * share[:, None]
            mean = np.zeros((len(angles), 6))
            np.add.at(mean, owner, each)
            return mean

        return compensate(T_base_tool, q, deflect, self.kinematics, self.T_flange_tool, self.tolerance)
