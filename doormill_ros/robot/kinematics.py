"""Forward kinematics, Jacobian and kinematic Hessian of any number of configurations."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.chain import JOINTS, KEPT, ChainFrames, chain_frames, cross, jacobian_columns
from doormill_ros.robot.description import Robot


class Kinematics:
    """Vectorised kinematics from the Denavit-Hartenberg table.

    The tests hold it to 1e-12 together with Pinocchio, which computes the same from the URDF, one
    configuration a call.
    """

    def __init__(self, robot: Robot | FloatArray) -> None:
        """Take a robot, or a bare Denavit-Hartenberg table, shape (6, 4)."""
        self.dh = np.array(robot.dh if isinstance(robot, Robot) else robot, dtype=float)
        if self.dh.shape != (JOINTS, 4):
            raise ValueError(f"the Denavit-Hartenberg table has shape {self.dh.shape}, allowed is (6, 4)")

    def forward(self, q: FloatArray) -> FloatArray:
        """T_base_flange, shape (..., 4, 4), of joint angles q, shape (..., 6) [rad] (thesis eq. 2.1)."""
        columns, shape = _columns(q)
        frames = chain_frames(self.dh, columns)
        T = np.zeros((columns.shape[1], 4, 4))
        for column, part in enumerate((frames.x, frames.y, frames.z, frames.origin)):
            T[:, :3, column] = part[JOINTS].T
        T[:, 3, 3] = 1.0
        return T.reshape(*shape, 4, 4)

    def link_frames(self, q: FloatArray) -> FloatArray:
        """T_base_i of the Denavit-Hartenberg frames i = 0..6, shape (..., 7, 4, 4).

        Frame i is fixed to moving link i; frame 0 is the base, frame 6 the flange.
        """
        columns, shape = _columns(q)
        frames = chain_frames(self.dh, columns)
        T = np.zeros((columns.shape[1], JOINTS + 1, 4, 4))
        for column, part in enumerate((frames.x, frames.y, frames.z, frames.origin)):
            T[:, :, :3, column] = part.transpose(2, 0, 1)
        T[:, :, 3, 3] = 1.0
        return T.reshape(*shape, JOINTS + 1, 4, 4)

    def jacobian(
        self, q: FloatArray, point_flange: FloatArray | tuple[float, ...] = (0.0, 0.0, 0.0)
    ) -> FloatArray:
        """Geometric Jacobian of a point of the flange frame (thesis eq. 2.29 to 2.31).

        Args:
            q: Joint angles, shape (..., 6) [rad].
            point_flange: The point, flange frame, shape (3,) [m].

        Returns:
            Shape (..., 6, 6), base axes: rows are the velocity of the point [m/rad], then the
            angular velocity of the flange [rad/rad].
        """
        return self.link_jacobian(q, JOINTS, point_flange)

    def link_jacobian(
        self, q: FloatArray, link: int, point: FloatArray | tuple[float, ...] = (0.0, 0.0, 0.0)
    ) -> FloatArray:
        """Geometric Jacobian of a point fixed to any link.

        Args:
            q: Joint angles, shape (..., 6) [rad].
            link: Moving link that carries the point, 0 (base) to 6 (flange).
            point: The point in the link's Denavit-Hartenberg frame, shape (3,) [m].

        Returns:
            Shape (..., 6, 6) as `jacobian`; columns of joints behind the link are zero. Locked, as others may be
            given the same.

        Raises:
            ValueError: No such link.
        """
        if not 0 <= link <= JOINTS:
            raise ValueError(f"link {link} does not exist, allowed are 0 (base) to {JOINTS} (flange)")
        columns, shape = _columns(q)
        frames, position = chain_frames(self.dh, columns), np.asarray(point, dtype=float)
        key = (link, position.tobytes())
        J = frames.jacobians.get(key)
        if J is None:
            J = _jacobian(frames, link, position)
            if len(frames.jacobians) >= KEPT:
                frames.jacobians.clear()
            frames.jacobians[key] = J
        return J.reshape(*shape, 6, JOINTS)

    def hessian(
        self, q: FloatArray, point_flange: FloatArray | tuple[float, ...] = (0.0, 0.0, 0.0)
    ) -> FloatArray:
        """Exact derivative of `jacobian`: H[..., i, j, k] = d J[..., i, j] / d q[k].

        A joint k at or before joint j carries the whole column round: z_k x column. A joint
        behind j moves only the lever arm: z_j x (velocity of the point due to joint k).

        Args:
            q: Joint angles, shape (..., 6) [rad].
            point_flange: The point, flange frame, shape (3,) [m].

        Returns:
            Shape (..., 6, 6, 6), base axes.
        """
        columns, shape = _columns(q)
        frames = chain_frames(self.dh, columns)
        velocity = jacobian_columns(frames, frames.point(JOINTS, np.asarray(point_flange, dtype=float)))
        H = np.zeros((columns.shape[1], 6, JOINTS, JOINTS))
        for k in range(JOINTS):
            for j in range(JOINTS):
                if k <= j:
                    H[:, :3, j, k] = cross(frames.z[k], velocity[j]).T
                    H[:, 3:, j, k] = cross(frames.z[k], frames.z[j]).T
                else:
                    H[:, :3, j, k] = cross(frames.z[j], velocity[k]).T
        return H.reshape(*shape, 6, JOINTS, JOINTS)


def _jacobian(frames: ChainFrames, link: int, point: FloatArray) -> FloatArray:
    """Of a point of a link in n configurations, locked, shape (n, 6, 6)."""
    velocity = jacobian_columns(frames, frames.point(link, point), link)
    J = np.zeros((velocity.shape[-1], 6, JOINTS))
    J[:, :3] = velocity.transpose(2, 1, 0)
    J[:, 3:, :link] = frames.z[:link].transpose(2, 1, 0)
    J.setflags(write=False)
    return J


def _columns(q: FloatArray) -> tuple[FloatArray, tuple[int, ...]]:
    """Joint angles with the configurations last, shape (6, n), and the shape in front."""
    q = np.asarray(q, dtype=float)
    if q.shape[-1:] != (JOINTS,):
        raise ValueError(f"joint angles have shape {q.shape}, allowed is (..., 6)")
    return np.ascontiguousarray(q.reshape(-1, JOINTS).T), q.shape[:-1]
