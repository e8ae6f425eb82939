"""The thesis' compliance model: rigid links on six torsion springs."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics


class JointSpringModel:
    """Small deflections of a robot whose joints are linear springs (implements ComplianceModel).

    Every joint between the base and the load gives way; the complementary stiffness matrix, which `batch.complementary`
    works out, is left out here as in the thesis (section 3.4).
    """

    def __init__(self, robot: Robot, stiffness: FloatArray | None = None) -> None:
        """Take a robot and, in place of its own, joint stiffness values.

        Args:
            robot: The robot.
            stiffness: Joint stiffness, shape (6,) [N m/rad]; infinity for a rigid joint.

        Raises:
            ValueError: Not six positive numbers.
        """
        values = np.array(robot.stiffness if stiffness is None else stiffness, dtype=float)
        if values.shape != (6,) or not np.all(values > 0):
            raise ValueError(f"joint stiffness is {values}, allowed are 6 positive numbers in N m/rad")
        self.robot = robot
        self.kinematics = Kinematics(robot)
        self.stiffness = values
        self.stiffness.setflags(write=False)
        self.remembers = False

    def torque(self, q: FloatArray, wrench: FloatArray, load_point: FloatArray, link: int = 6) -> FloatArray:
        """Joint torques that a wrench causes (thesis eq. 2.34).

        Args:
            q: Joint angles, shape (..., 6) [rad].
            wrench: Wrench on the robot at the load point, base axes, shape (..., 6) [N, N m].
            load_point: Point of the link's frame at which it acts, shape (3,) [m].
            link: Link that carries the load point; 6 is the flange.

        Returns:
            Shape (..., 6) [N m].
        """
        J = self.kinematics.link_jacobian(q, link, load_point)
        result: FloatArray = np.einsum("...ij,...i->...j", J, np.asarray(wrench, dtype=float))
        return result

    def joint_deflection(
        self, q: FloatArray, wrench: FloatArray, load_point: FloatArray, link: int = 6
    ) -> FloatArray:
        """Joint angles by which the springs give way, shape (..., 6) [rad] (thesis eq. 3.44)."""
        result: FloatArray = self.torque(q, wrench, load_point, link) / self.stiffness
        return result

    def deflection(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Twist of the loaded tool (thesis eq. 3.45).

        Args:
            q: Commanded joint angles, shape (n, 6) [rad].
            wrench: Wrench on the robot at the load point, base axes, shape (n, 6) [N, N m].
            load_point: Point in the flange frame at which the wrench acts, shape (3,) [m].
            direction: Not used: linear springs do not remember how a joint arrived.

        Returns:
            Displacement of the load point and rotation of the flange, base axes, shape (n, 6) [m, rad].
        """
        del direction
        return spring_twist(self.kinematics.jacobian(q, load_point), wrench, self.stiffness)

    def displacement(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        reflector_link: int,
        reflector: FloatArray,
        load_link: int = 6,
    ) -> FloatArray:
        """How far a reflector anywhere on the robot moves under a load anywhere on the robot.

        Args:
            q: Joint angles, shape (..., 6) [rad].
            wrench: Wrench on the robot at the load point, base axes, shape (..., 6) [N, N m].
            load_point: Point at which it acts, frame of `load_link`, shape (3,) [m].
            reflector_link: Link that carries the reflector, 0 (base) to 6 (flange).
            reflector: Its position in that link's Denavit-Hartenberg frame, shape (3,) [m].
            load_link: Link that carries the load point.

        Returns:
            Displacement, base axes, shape (..., 3) [m]. Joints behind the reflector do not move
            it; joints behind the load are not loaded.
        """
        bent = self.joint_deflection(q, wrench, load_point, load_link)
        J = self.kinematics.link_jacobian(q, reflector_link, reflector)
        result: FloatArray = np.einsum("...ij,...j->...i", J[..., :3, :], bent)
        return result


def spring_twist(J: FloatArray, wrench: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Twist J K^-1 J^T W of loaded tools on joint springs (thesis eq. 3.45).

    Args:
        J: Jacobian of the load point, shape (..., 6, 6).
        wrench: At that point, axes of J, shape (..., 6) [N, N m].
        stiffness: Shape (6,) [N m/rad].

    Returns:
        Shape (..., 6) [m, rad].
    """
    torque = np.einsum("...ij,...i->...j", J, np.asarray(wrench, dtype=float))
    result: FloatArray = np.einsum("...ij,...j->...i", J, torque / stiffness)
    return result
