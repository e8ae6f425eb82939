"""Cartesian stiffness and compliance of the loaded robot, with and without K_c.

    K_x = J^-T (K_theta - K_c) J^-1        thesis eq. 2.39
    K_c[j, k] = (d J_j / d q_k) . W        thesis eq. 2.38

K_c follows from the equilibrium K_theta dq = J(q + dq)^T W of a wrench that keeps its direction in
the base frame and acts on a point that moves along: to first order (K_theta - K_c) dq = J^T W.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.robot.chain import JOINTS, ChainFrames, chain_frames, jacobian_columns
from doormill_ros.robot.errors import SingularityError
from doormill_ros.robot_model.elastic.batch import complementary, joint_torque, solve_springs, twist
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel

_FLANGE = (0.0, 0.0, 0.0)
_SINGULAR = 1e-9  # ratio of the Jacobian's singular values below which it has no inverse


class CartesianStiffness:
    """What the tool feels of the six joint springs."""

    def __init__(self, model: JointSpringModel) -> None:
        """Take the springs and the kinematics of a joint spring model."""
        self.model = model
        self.stiffness = model.stiffness

    def complementary(
        self, q: np.ndarray, wrench: np.ndarray, point_flange: np.ndarray | tuple[float, ...] = _FLANGE
    ) -> np.ndarray:
        """Complementary stiffness K_c, shape (..., 6, 6) [N m/rad].

        Args:
            q: Joint angles, shape (..., 6) [rad].
            wrench: Wrench on the robot at the point, base axes, shape (6,) or (..., 6) [N, N m].
            point_flange: Load point, flange frame, shape (3,) [m].
        """
        frames, velocity, columns, shape = self._prepare(q, wrench, point_flange)
        return complementary(frames, velocity, columns).transpose(2, 0, 1).reshape(*shape, JOINTS, JOINTS)

    def compliance(self, q: np.ndarray, point_flange: np.ndarray | tuple[float, ...] = _FLANGE) -> np.ndarray:
        """J K_theta^-1 J^T, shape (..., 6, 6) [m/N, rad/N, rad/(N m)]; defined at singularities too."""
        J = self.model.kinematics.jacobian(q, point_flange)
        return (J / self.stiffness) @ np.swapaxes(J, -1, -2)

    def stiffness_matrix(
        self,
        q: np.ndarray,
        wrench: np.ndarray | None = None,
        point_flange: np.ndarray | tuple[float, ...] = _FLANGE,
    ) -> np.ndarray:
        """K_x, shape (..., 6, 6) [N/m, N/rad, N m/rad] (thesis eq. 2.39, or 2.40 without a wrench).

        Args:
            q: Joint angles, shape (..., 6) [rad].
            wrench: Wrench whose K_c counts, base axes, shape (6,) or (..., 6); None for none.
            point_flange: Point at which the stiffness is felt, flange frame, shape (3,) [m].

        Raises:
            SingularityError: The Jacobian has no inverse: some direction is infinitely stiff.
        """
        J = self.model.kinematics.jacobian(q, point_flange)
        values = np.linalg.svd(J, compute_uv=False)
        worst = float((values[..., -1] / values[..., 0]).min())
        if worst < _SINGULAR:
            raise SingularityError(
                f"{self.model.robot.label} stands in a singularity (ratio of singular values {worst:.1e}, "
                f"allowed is {_SINGULAR:.0e}); use the compliance, which exists there",
                ratio=worst,
            )
        inner = np.broadcast_to(np.diag(self.stiffness), J.shape)
        if wrench is not None:
            inner = inner - self.complementary(q, wrench, point_flange)
        J_inverse = np.linalg.inv(J)
        return np.swapaxes(J_inverse, -1, -2) @ inner @ J_inverse

    def deflection(
        self,
        q: np.ndarray,
        wrench: np.ndarray,
        point_flange: np.ndarray | tuple[float, ...] = _FLANGE,
    ) -> np.ndarray:
        """J (K_theta - K_c)^-1 J^T W: the tool's twist with K_c, shape (..., 6) [m, rad].

        `JointSpringModel.deflection` gives the same without K_c.

        Args:
            q: Joint angles, shape (..., 6) [rad].
            wrench: Wrench on the robot at the point, base axes, shape (6,) or (..., 6) [N, N m].
            point_flange: Load point, flange frame, shape (3,) [m].
        """
        frames, velocity, columns, shape = self._prepare(q, wrench, point_flange)
        K_c = complementary(frames, velocity, columns)
        dq = solve_springs(self.stiffness, K_c, joint_torque(frames, velocity, columns))
        return twist(frames, velocity, dq).T.reshape(*shape, 6)

    def _prepare(
        self, q: np.ndarray, wrench: np.ndarray, point_flange: np.ndarray | tuple[float, ...]
    ) -> tuple[ChainFrames, np.ndarray, np.ndarray, tuple[int, ...]]:
        q = np.asarray(q, dtype=float)
        shape = q.shape[:-1]
        flat = np.ascontiguousarray(q.reshape(-1, JOINTS).T)
        columns = np.broadcast_to(np.asarray(wrench, dtype=float), (*shape, 6)).reshape(-1, 6).T
        frames = chain_frames(self.model.kinematics.dh, flat)
        velocity = jacobian_columns(frames, frames.point(JOINTS, np.asarray(point_flange, dtype=float)))
        return frames, velocity, columns, shape
