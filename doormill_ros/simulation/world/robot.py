"""The arm of a world: links as they were made, springs, gaps, and what its own weight does to it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.truth.chain import chain
from doormill_ros.simulation.truth.effects import Physics
from doormill_ros.simulation.truth.elasticity import joint_give
from doormill_ros.simulation.truth.robot import DEFAULT_STIFFNESS
from doormill_ros.simulation.world.world_file import (
    JOINTS,
    GeometryErrors,
    LinksOfWorld,
    RobotOfWorld,
    ToolOfWorld,
)

GRAVITY = np.array([0.0, 0.0, -9.80665])  #: base axes [m/s^2]
LENGTHS, ANGLES = (1, 2), (0, 3)  #: columns of a Denavit-Hartenberg table
ARM = 1.0  #: over which an error of an angle makes what an error of a length makes [m]


class WorldRobot:
    """Six joints that turn under load.

    Attributes:
        dh: The true table [theta_offset, d, a, alpha], shape (6, 4) [rad, m, m, rad].
    """

    def __init__(
        self,
        dh: FloatArray,
        robot: RobotOfWorld,
        tool: ToolOfWorld | None = None,
        links: LinksOfWorld | None = None,
    ) -> None:
        """Build the arm from the published table, shape (6, 4)."""
        self.dh = np.asarray(dh, dtype=float) + geometry_errors(robot.pose_error)
        self._physics = Physics(
            DEFAULT_STIFFNESS * np.array(robot.stiffness_factor),
            gap=np.array(robot.gap),
            crossing=np.full(JOINTS, robot.crossing),
        )
        self._tool = tool or ToolOfWorld()
        self._masses = (links or LinksOfWorld()).masses

    def flange(
        self, q: FloatArray, wrench: FloatArray, load_point: FloatArray, direction: FloatArray
    ) -> FloatArray:
        """Where the flange really is.

        Loads are balanced on the undeformed arm. The joints' torques are those of process and weight together; which
        flank of its gap a joint lies against follows from that sum.

        Args:
            q: Commanded joint angles, shape (n, 6) [rad].
            wrench: Of the process on the tool at the load point, base axes, shape (n, 6) [N, N m].
            load_point: Flange frame, shape (3,) [m].
            direction: Last motion of each joint, -1, 0 or +1, shape (n, 6).

        Returns:
            T_base_flange, shape (n, 4, 4).
        """
        frames = chain(self.dh, q)
        torque = self.torques(frames, wrench, load_point)
        give = [joint_give(self._physics, k, q[:, k], torque[:, k], direction[:, k]) for k in range(JOINTS)]
        return chain(self.dh, q + np.stack(give, axis=1))[:, -1]

    def torques(self, frames: FloatArray, wrench: FloatArray, load_point: FloatArray) -> FloatArray:
        """Torque of all loads about each joint's axis, shape (n, 6) [N m].

        Args:
            frames: Frames 0 to 6 in base, shape (n, 7, 4, 4).
            wrench: See `flange`.
            load_point: See `flange`.
        """
        axis, origin = frames[:, :JOINTS, :3, 2], frames[:, :, :3, 3]
        flange = frames[:, -1]
        point = _placed(flange, load_point)
        moment = wrench[:, None, 3:] + np.cross(
            point[:, None] - origin[:, :JOINTS], wrench[:, None, :3]
        )  # (n, 6, 3)
        weights = [(JOINTS, self._tool.mass, _placed(flange, self._tool.com))]
        # Nobody tells where a link's centre of mass is: half way between its ends.
        weights += [
            (k, mass, 0.5 * (origin[:, k - 1] + origin[:, k])) for k, mass in enumerate(self._masses, 1)
        ]
        for link, mass, centre in weights:
            moment[:, :link] += np.cross(centre[:, None] - origin[:, :link], mass * GRAVITY)
        torque: FloatArray = np.sum(moment * axis, axis=2)
        return torque


def geometry_errors(errors: GeometryErrors) -> FloatArray:
    """What is added to a Denavit-Hartenberg table, shape (6, 4) [rad, m, m, rad]."""
    drawn = np.random.default_rng(errors.seed).standard_normal((JOINTS, 4))
    for columns, size in ((LENGTHS, errors.size), (ANGLES, errors.size / ARM)):
        part = drawn[:, columns]
        drawn[:, columns] = part * size / np.sqrt(np.mean(part**2))
    return drawn


def _placed(T_base_flange: FloatArray, point: FloatArray) -> FloatArray:
    """Points in base, shape (n, 3) [m], of one in the flange frame, shape (3,)."""
    placed: FloatArray = T_base_flange[:, :3, :3] @ np.asarray(point, dtype=float) + T_base_flange[:, :3, 3]
    return placed
