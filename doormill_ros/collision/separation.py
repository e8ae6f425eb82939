"""How far apart bodies stay about a posture in which their distance and a plane between them are known.

No point of a body moves further than the sum of the joints' turns, each times its reach. A plane mostly tells more.
Two convex bodies are apart by no less than their gap along any direction. Joints that turn by s carry a point of the
moving body along the direction by n . J s, but for a second part of no more than half the sum over all pairs of joints
of |s_i| |s_j| times the reach of the later one: what turns the arm of a joint turns it no faster than that joint's own
speed. So a tool that draws back from a face is known to be clear of it over a long way, however close it begins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.robot.chain import JOINTS

#: Of a body its three half edges, then its middle.
EDGES, MIDDLE = slice(0, 3), 3
#: The vector product of each unit vector with others, as matrices on those, shape (3, 3, 3).
_CROSS = np.array([np.cross(axis, np.eye(3)).T for axis in np.eye(3)])


@dataclass(frozen=True, eq=False)
class Separation:
    """Pairs of bodies on either side of a plane in one posture.

    Attributes:
        gap: Of the moving body's middle from the other body, and its half edges, along the plane's normal, shape
            (p, 4) [m].
        slope: How fast each joint changes them, shape (p, 4, 6) [m/rad].
        curve: Largest second derivative of any point of it by each two joints, shape (p, 36) [m/rad^2].
    """

    gap: FloatArray
    slope: FloatArray
    curve: FloatArray

    def lowest(self, step: FloatArray, off: FloatArray | None = None) -> FloatArray:
        """Distances that the planes leave the pairs at least, shape (m, p) [m].

        The bound is concave: what holds at two steps holds on the straight line between them.

        Args:
            step: Of the joints from the posture, shape (m, 6) [rad].
            off: How far each joint may be beside that, shape (m, 6) or (6,) [rad]; None for not at all.
        """
        m, slope = len(step), self.slope.reshape(-1, JOINTS).T
        turned, along = np.abs(step), (step @ slope).reshape(m, *self.gap.shape) + self.gap
        lowest: FloatArray = along[..., MIDDLE] - np.abs(along[..., EDGES]).sum(axis=2)
        if off is not None:
            turned = turned + off
            lowest -= (off @ np.abs(slope)).reshape(-1, *self.gap.shape).sum(axis=2)
        lowest -= 0.5 * (turned[:, :, None] * turned[:, None, :]).reshape(m, -1) @ self.curve.T
        return lowest


class Bodies:
    """Boxes and capsules on the joints of an arm, as they stand in one posture."""

    def __init__(
        self, half: FloatArray, margin: FloatArray, joint: IntArray, T_joint_body: FloatArray
    ) -> None:
        """Take n bodies.

        Args:
            half: Half edges along each one's own axes, of a capsule the third alone, shape (n, 3) [m].
            margin: By how much each is wider than that, shape (n,) [m].
            joint: That carries it, 1 to 6, 0 for none, shape (n,).
            T_joint_body: Its middle in the joint's frame, shape (n, 4, 4).
        """
        self._margin, self._joint = margin, joint
        self._own = T_joint_body.copy()
        self._own[:, :3, EDGES] *= half[:, None]
        # Half edges and middles in columns, base axes, shape (n, 3, 4) [m].
        self._edges: FloatArray = self._own[:, :3]

    def stand(self, T_base_joint: FloatArray) -> None:
        """Put them where their joints are now, shape (7, 4, 4)."""
        self._edges = T_base_joint[self._joint, :3] @ self._own

    def gap_and_slope(
        self, pairs: IntArray, normal: FloatArray, J: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """As in `Separation`, were all joints to move all moving bodies.

        Args:
            pairs: Number of the moving body of each pair, and of the other one, shape (2, p).
            normal: Of a plane between the two, towards the moving one, shape (p, 3).
            J: Velocity of what passes the base's origin and angular velocity, by each joint, shape (6, 6).
        """
        moving, still = self._edges[pairs]  # (p, 3, 4) each
        gap: FloatArray = (normal[:, None] @ moving)[:, 0]  # (p, 4)
        other = (normal[:, None] @ still)[:, 0]
        other[:, EDGES] = np.abs(other[:, EDGES])
        gap[:, MIDDLE] -= other.sum(axis=1) + self._margin[pairs].sum(axis=0)
        across = (normal @ (_CROSS @ J[3:]).reshape(3, -1)).reshape(
            -1, 3, JOINTS
        )  # normal x axis of each joint
        slope: FloatArray = np.swapaxes(moving, 1, 2) @ across
        slope[:, MIDDLE] += normal @ J[:3]
        return gap, slope


def curve_of(reach: FloatArray) -> FloatArray:
    """Largest second derivatives of a point by each two joints, shapes (p, 6) [m] -> (p, 36) [m/rad^2].

    Args:
        reach: How far it can be from the axis of each joint that moves it, 0 for the others.
    """
    later = np.maximum.accumulate(reach[:, ::-1], axis=1)[
        :, ::-1
    ]  # falls from joint to joint: a convex curve
    i = np.arange(JOINTS)
    moves = reach > 0.0
    both = moves[:, :, None] & moves[:, None, :]
    curve: FloatArray = np.where(both, later[:, np.maximum(i[:, None], i)], 0.0)
    return curve.reshape(len(reach), -1)
