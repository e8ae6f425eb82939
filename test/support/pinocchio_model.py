"""Forward kinematics, Jacobian and Hessian of one configuration by pinocchio, from the URDF."""

from __future__ import annotations

import numpy as np
import pinocchio

from doormill_ros.robot.description import Robot


class PinocchioKinematics:
    """Pinocchio's model of a robot; shares nothing with `Kinematics` but the URDF."""

    def __init__(self, robot: Robot) -> None:
        """Build the model from the robot's URDF."""
        self.model = pinocchio.buildModelFromUrdf(str(robot.urdf))
        self.data = self.model.createData()
        self.frame = self.model.getFrameId(robot.flange_link)

    def forward(self, q: np.ndarray) -> np.ndarray:
        """T_base_flange, shape (4, 4), at q, shape (6,) [rad]."""
        pinocchio.framesForwardKinematics(self.model, self.data, np.asarray(q, dtype=float))
        return self.data.oMf[self.frame].homogeneous.copy()

    def jacobian(
        self, q: np.ndarray, point_flange: np.ndarray | tuple[float, ...] = (0.0, 0.0, 0.0)
    ) -> np.ndarray:
        """Geometric Jacobian, shape (6, 6), base axes, of a point of the flange frame [m]."""
        q = np.asarray(q, dtype=float)
        J = pinocchio.computeFrameJacobian(
            self.model, self.data, q, self.frame, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        lever = self._lever(point_flange)
        J[:3] += np.cross(J[3:].T, lever).T
        return J

    def hessian(
        self, q: np.ndarray, point_flange: np.ndarray | tuple[float, ...] = (0.0, 0.0, 0.0)
    ) -> np.ndarray:
        """Derivative of `jacobian` to each joint, shape (6, 6, 6): [i, j, k] = d J[i, j] / d q[k]."""
        q = np.asarray(q, dtype=float)
        J = self.jacobian(q, point_flange)
        point = self.data.oMf[self.frame].translation + self._lever(point_flange)
        H = np.empty((6, self.model.nv, self.model.nv))
        for k in range(self.model.nv):
            # The Jacobian's change with time while joint k alone turns at 1 rad/s, at base's origin; older
            # releases have no Hessian of their own, newer ones reverse its indices (seen in 4.1).
            pinocchio.computeJointJacobiansTimeVariation(self.model, self.data, q, np.eye(self.model.nv)[k])
            H[:, :, k] = pinocchio.getFrameJacobianTimeVariation(
                self.model, self.data, self.frame, pinocchio.ReferenceFrame.WORLD
            )
            H[:3, :, k] += (np.cross(H[3:, :, k].T, point) + np.cross(J[3:].T, J[:3, k])).T
        return H

    def _lever(self, point_flange: np.ndarray | tuple[float, ...]) -> np.ndarray:
        pinocchio.updateFramePlacements(self.model, self.data)
        return self.data.oMf[self.frame].rotation @ np.asarray(point_flange, dtype=float)
