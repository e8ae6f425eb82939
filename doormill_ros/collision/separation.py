"""How far apart bodies stay while joints move, as far as a plane between them in one posture tells.

Two convex bodies are apart by no less than their gap along any direction, so a plane that is kept with the body that
moves less tells something in every posture, exactly. A point of the other one bends off the chord between two postures
by no more than an eighth of the sum over all pairs of joints of |s_i| |s_j| times the reach of the later one, s being
what the joints turn by: what turns the arm of a joint turns it no faster than that joint's own speed. The same holds
about the hull of more than two postures, s being how far they lie apart. So a tool that draws back from a face is known
to be clear of it over a long way, however close it begins.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.collision.skeleton import Skeleton
from doormill_ros.robot.chain import JOINTS

#: Of a body its three half edges, then its middle.
EDGES, MIDDLE = slice(0, 3), 3


class Bodies:
    """Boxes and capsules on the joints of an arm."""

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
        self._own = T_joint_body.swapaxes(1, 2)[..., :3].copy()  # (n, 4, 3)
        self._own[:, EDGES] *= half[:, :, None]
        of_joint = [np.flatnonzero(joint == number) for number in range(JOINTS + 1)]
        self._by_joint = [self._own[bodies, MIDDLE] for bodies in of_joint]
        self._number = np.argsort(np.concatenate(of_joint))  # of each body in that order
        self._ball = np.sqrt((self._own[:, EDGES] ** 2).sum(axis=(1, 2)))  # from a middle to a corner

    def middles(self, T_base_joint: FloatArray) -> FloatArray:
        """Where they stand, as in `Region`, shapes (7, 3, 4, m) -> (3, n, m) [m]."""
        parts = [own @ T[:, :3] + T[:, None, 3] for own, T in zip(self._by_joint, T_base_joint, strict=True)]
        return np.concatenate(parts, axis=1)

    def rough_gap(self, pairs: IntArray, normal: FloatArray, region: Region) -> FloatArray:
        """No more than `gap`, by the ball round the moving body, which mostly tells enough in half the time."""
        apart = self._apart(pairs, self._across(pairs, normal, region), region)
        apart -= (self._ball[pairs[0]] + self._behind(pairs, normal))[:, None]
        return apart

    def gap(self, pairs: IntArray, normal: FloatArray, region: Region) -> FloatArray:
        """Gaps of pairs along planes in the n postures of a region, shape (p, n) [m].

        Args:
            pairs: Number of the moving body of each pair, and of the other one, shape (2, p).
            normal: Of a plane kept with the joint of the latter, in its frame, towards the moving one, shape (p, 3).
            region: The postures.
        """
        across = self._across(pairs, normal, region)
        R_base_joint = region.T_base_joint[self._joint[pairs[0]], :, :3]  # (p, 3, 3, n)
        own = np.einsum("apn,pakn->pkn", across, R_base_joint)  # the normals, axes of the moving body's joint
        ahead = np.abs(self._own[pairs[0], EDGES] @ own).sum(axis=1)
        gap = self._apart(pairs, across, region)
        gap -= ahead + self._behind(pairs, normal)[:, None]
        return gap

    def _across(self, pairs: IntArray, normal: FloatArray, region: Region) -> FloatArray:
        """The normals in base axes; arguments as of `gap`, shape (3, p, n)."""
        joint = self._joint[pairs[1]]
        across = np.empty((3, len(joint), len(region.q)))
        still = joint == 0
        across[:, still] = normal[still].T[:, :, None]
        for number in sorted(set(joint.tolist()) - {0}):
            own = np.flatnonzero(joint == number)
            across[:, own] = normal[own] @ region.T_base_joint[number, :, :3]
        return across

    def _apart(self, pairs: IntArray, across: FloatArray, region: Region) -> FloatArray:
        """How far the middles are apart along normals of shape (3, p, n), shape (p, n) [m]."""
        moving, other = self._number[pairs]
        way = region.middles.take(moving, axis=1) - region.middles.take(other, axis=1)
        way *= across
        apart: FloatArray = way.sum(axis=0)
        return apart

    def _behind(self, pairs: IntArray, normal: FloatArray) -> FloatArray:
        """How far the second body of each pair reaches along its plane, with the margins of both, shape (p,) [m]."""
        half = np.abs((self._own[pairs[1], EDGES] @ normal[:, :, None])[..., 0]).sum(axis=1)
        behind: FloatArray = half + self._margin[pairs].sum(axis=0)
        return behind


@dataclass(frozen=True, eq=False)
class Region:
    """All postures in the hulls of some, each hull widened.

    Attributes:
        q: n postures, shape (n, 6) [rad].
        hulls: Numbers of those that each hull is of, shape (h, c).
        off: How far each joint may be beside a hull, shape (h, 6) [rad].
        bones: Joints of the robot.
        bodies: On them.
    """

    q: FloatArray
    hulls: IntArray
    off: FloatArray
    bones: Skeleton
    bodies: Bodies

    @functools.cached_property
    def T_base_joint(self) -> FloatArray:
        """Joints 0 (base) to 6 in the postures, without the last row, shape (7, 3, 4, n)."""
        return self.bones.frames(self.q)

    @functools.cached_property
    def middles(self) -> FloatArray:
        """Middles of all bodies there, base axes, shape (3, bodies, n) [m]."""
        return self.bodies.middles(self.T_base_joint)

    @functools.cached_property
    def spread(self) -> FloatArray:
        """Product of how far the postures of a hull lie apart in each two joints, shape (36, h) [rad^2]."""
        corners = self.q[self.hulls]
        apart = (corners.max(axis=1) - corners.min(axis=1)).T
        spread: FloatArray = (apart[:, None] * apart).reshape(JOINTS**2, -1)
        return spread

    def turned(self, here: FloatArray) -> FloatArray:
        """How far each joint turns at most from a posture into each hull itself, shapes (6,) -> (h, 6) [rad]."""
        most: FloatArray = np.abs(self.q - here)[self.hulls].max(axis=1)
        return most


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
