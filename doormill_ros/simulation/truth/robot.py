"""The robot as it really is in simulation: elastic, worn and never seen by the models that question it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.truth.chain import chain, joint_matrix, shift, turn
from doormill_ros.simulation.truth.effects import read_effects
from doormill_ros.simulation.truth.elasticity import cantilever, joint_give

#: Springs of table 4.1 of the thesis times the stiffness that its joint 1 test gives,
#: 176 N x 1.842 m x 0.495 m / 65.7 um [N m / rad].
DEFAULT_STIFFNESS = 2.44e6 * np.array([1.0, 0.887, 0.6892, 0.141, 0.048, 0.0187])


class TruthRobot:
    """Own kinematics and own physics of a six-joint arm under load.

    Attributes:
        dh: Table [theta_offset, d, a, alpha], shape (6, 4), Rz Tz Tx Rx.
        physics: Sizes of all effects.
    """

    def __init__(
        self,
        dh: FloatArray,
        effects: Iterable[Mapping[str, Any]] = (),
        stiffness: FloatArray | None = None,
    ) -> None:
        """Build the robot.

        Args:
            dh: Table, shape (6, 4) [rad, m, m, rad].
            effects: What the robot hides, each `{cause, where, parameters}`; joint springs always act.
            stiffness: Joint springs without effects, shape (6,) [N m / rad]; default DEFAULT_STIFFNESS.

        Raises:
            ValueError: Wrong table shape or unreadable effect.
        """
        self.dh = np.array(dh, dtype=float)
        if self.dh.shape != (6, 4):
            raise ValueError(f"DH table has shape {self.dh.shape}, allowed is (6, 4)")
        self.physics = read_effects(
            effects, DEFAULT_STIFFNESS if stiffness is None else np.asarray(stiffness)
        )

    def forward(self, q: FloatArray) -> FloatArray:
        """Pose T_base_flange, shape (n, 4, 4), of the unloaded robot at commanded q (n, 6) [rad]."""
        return self.link_frames(q)[:, 6]

    def link_frames(self, q: FloatArray) -> FloatArray:
        """Frames 0 to 6 of the unloaded robot, shape (n, 7, 4, 4), at commanded q (n, 6) [rad]."""
        return chain(self.dh, np.atleast_2d(np.asarray(q, dtype=float)) + self.physics.offset)

    def deflected(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Actual T_base_flange of the loaded robot; arguments as in `deflected_frames`, shape (n, 4, 4)."""
        return self.deflected_frames(q, wrench, load_point, direction)[:, 6]

    def deflected_frames(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Frames of all links of the loaded robot.

        The wrench is balanced on the undeformed robot; the deformations are then chained as
        finite motions. Gravity is left out.

        Args:
            q: Commanded joint angles, shape (n, 6) [rad].
            wrench: Wrench on the robot at the load point, base axes, shape (n, 6) [N, N m].
            load_point: Point of the flange frame, shape (3,) [m].
            direction: Last motion of each joint, -1, 0 or +1, shape (n, 6); None is all 0 (pre-loaded).

        Returns:
            Frame i rides on the far end of link i; frame 6 includes a soft tool mount. Shape (n, 7, 4, 4).
        """
        q = np.atleast_2d(np.asarray(q, dtype=float))
        wrench = np.broadcast_to(np.asarray(wrench, dtype=float), (len(q), 6))
        direction = np.zeros_like(q) if direction is None else np.broadcast_to(direction, q.shape)
        force, couple = wrench[:, :3], wrench[:, 3:]
        rigid = self.link_frames(q)
        actual_q = q + self.physics.offset
        origin = rigid[:, :, :3, 3]
        point = (rigid[:, 6] @ np.append(np.asarray(load_point, dtype=float), 1.0))[:, :3]

        def moment_at(i: int) -> FloatArray:
            return couple + np.cross(point - origin[:, i], force)

        def in_frame(i: int, vector: FloatArray) -> FloatArray:
            turned: FloatArray = np.einsum("nji,nj->ni", rigid[:, i, :3, :3], vector)
            return turned

        none = np.zeros_like(force)
        tilt = moment_at(0) * np.append(self.physics.base, 0.0)
        frames = [shift(turn(tilt), none)]
        for k in range(6):
            moment = in_frame(k, moment_at(k))
            twist = moment * self.physics.cross[k]
            twist[:, 2] = joint_give(self.physics, k, actual_q[:, k], moment[:, 2], direction[:, k])
            frame = frames[-1] @ shift(turn(twist), none) @ joint_matrix(self.dh[k], actual_q[:, k])
            if self.physics.bending[k] or self.physics.torsion[k]:
                displacement, rotation = cantilever(
                    self.physics.bending[k],
                    self.physics.torsion[k],
                    in_frame(k + 1, origin[:, k + 1] - origin[:, k]),
                    in_frame(k + 1, force),
                    in_frame(k + 1, moment_at(k + 1)),
                )
                frame = frame @ shift(turn(rotation), displacement)
            frames.append(frame)
        mount = in_frame(6, moment_at(6)) * np.append(self.physics.tool, 0.0)
        frames[6] = frames[6] @ shift(turn(mount), none)
        return np.stack(frames, axis=1)
