"""The grid over joints 2 and 3 on which the maps are drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import Robot
from doormill_ros.units import DEG

THESIS_STEP = 0.007  #: step of the thesis' maps [rad] (appendices A.14, A.15)


@dataclass(frozen=True, eq=False)
class JointGrid:
    """Values of joints 2 and 3, and what the other joints do.

    Attributes:
        q2: Values of joint 2, shape (n2,) [rad].
        q3: Values of joint 3, shape (n3,) [rad].
        others: Joints 1, 4, 5 and 6, shape (4,) [rad].
        tool_along_x: True to turn the wrist so that the tool points along base x in every posture,
            as it does at a hinge, in place of the fixed joints 4 to 6.
    """

    q2: FloatArray
    q3: FloatArray
    others: tuple[float, float, float, float] = (0.0, 45 * DEG, 45 * DEG, 45 * DEG)
    tool_along_x: bool = False

    @property
    def shape(self) -> tuple[int, int]:
        """(n3, n2): joint 3 down the rows, joint 2 along the columns, as the thesis plots them."""
        return len(self.q3), len(self.q2)

    def joints(self, first: int, last: int) -> FloatArray:
        """Joint angles of rows first..last, configurations last, shape (6, n) [rad]."""
        q3 = self.q3[first:last]
        q = np.empty((JOINTS, len(q3) * len(self.q2)))
        q[1] = np.tile(self.q2, len(q3))
        q[2] = np.repeat(q3, len(self.q2))
        q[0], q[3], q[4], q[5] = (np.full(q.shape[1], angle) for angle in self.others)
        if self.tool_along_x:
            q[0], q[3], q[5] = 0.0, 0.0, -90 * DEG
            q[4] = np.angle(np.exp(-1j * (q[1] + q[2])))
        return q

    def sin_cos(self, first: int, last: int) -> tuple[FloatArray, FloatArray]:
        """Sine and cosine of `joints`, each shape (6, n), from those of the axes alone."""
        if self.tool_along_x:
            q = self.joints(first, last)
            return np.sin(q), np.cos(q)
        q3 = self.q3[first:last]
        parts = []
        for function in (np.sin, np.cos):
            values = np.empty((JOINTS, len(q3) * len(self.q2)))
            values[1] = np.tile(function(self.q2), len(q3))
            values[2] = np.repeat(function(q3), len(self.q2))
            values[[0, 3, 4, 5]] = function(np.array(self.others))[:, None]
            parts.append(values)
        return parts[0], parts[1]


def thesis_grid(robot: Robot, step: float = THESIS_STEP, tool_along_x: bool = False) -> JointGrid:
    """The study range of the thesis (sections 3.4, 3.5): joints 2 and 3 within the robot's limits.

    Starts at the lower limits and steps up, as the scripts of appendices A.14 and A.15 do.

    Args:
        robot: Whose limits bound the grid.
        step: Grid step [rad].
        tool_along_x: See `JointGrid`.

    Raises:
        ValueError: A step that is not positive or larger than the range.
    """
    if not 0.0 < step <= float(np.min(robot.upper[1:3] - robot.lower[1:3])):
        raise ValueError(f"the grid step is {step} rad, allowed is more than 0 and up to the joints' range")
    axes = [
        low + step * np.arange(int(np.floor((high - low) / step + 1e-9)) + 1)
        for low, high in zip(robot.lower[1:3], robot.upper[1:3], strict=True)
    ]
    return JointGrid(axes[0], axes[1], tool_along_x=tool_along_x)
