"""The seam between a robot that bends and everybody who needs to know by how much."""

from __future__ import annotations

from typing import Protocol

from doormill_ros.arrays import FloatArray


class ComplianceModel(Protocol):
    """Predicts how far the loaded robot gives way."""

    def deflection(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Twist of the loaded tool.

        Args:
            q: Commanded joint angles, shape (n, 6) [rad].
            wrench: Wrench on the robot at the load point, base axes, shape (n, 6) [N, N m].
            load_point: Point in the flange frame at which the wrench acts, shape (3,) [m].
            direction: Direction of each joint's last motion, -1, 0 (unknown) or +1, shape (n, 6).

        Returns:
            Displacement of the load point and rotation of the flange, base axes, shape (n, 6) [m, rad].
        """
        ...
