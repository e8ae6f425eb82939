"""Curves of the tool between programmed targets: straight lines, arcs, joint motions and corners."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.arrays import FloatArray
from doormill_ros.units import deg_to_rad, m_to_mm, rad_to_deg

#: Limits of MoveC as documented for the controller.
SHORTEST_CHORD = 0.1e-3  # m, from the start to the circle point and to the end
SMALLEST_ANGLE = deg_to_rad(1.0)  # between circle point and end, seen from the start
LARGEST_ARC = deg_to_rad(240.0)


class TcpCurve(Protocol):
    """A tool path with parameter u from 0 to 1."""

    @property
    def length(self) -> float:
        """Way of the tool centre point [m]."""
        ...

    @property
    def turn(self) -> float:
        """Angle by which the tool's orientation turns [rad]."""
        ...

    @property
    def end(self) -> FloatArray:
        """T_base_tool at u = 1, shape (4, 4)."""
        ...

    def poses(self, u: FloatArray) -> FloatArray:
        """T_base_tool, shape (n, 4, 4), at u (n,)."""
        ...


@dataclass(frozen=True, eq=False)
class TcpLine:
    """Straight line; the orientation turns evenly about one axis.

    Attributes:
        start: T_base_tool at u = 0, shape (4, 4).
        end: T_base_tool at u = 1, shape (4, 4).
    """

    start: FloatArray
    end: FloatArray

    @property
    def length(self) -> float:
        """Distance of the two points [m]."""
        return float(np.linalg.norm(self.end[:3, 3] - self.start[:3, 3]))

    @property
    def turn(self) -> float:
        """Angle between the two orientations [rad]."""
        return angle_between(self.start, self.end)

    def poses(self, u: FloatArray) -> FloatArray:
        """T_base_tool, shape (n, 4, 4), at u (n,)."""
        u = np.asarray(u, dtype=float)
        points = self.start[:3, 3] + u[:, None] * (self.end[:3, 3] - self.start[:3, 3])
        return _assemble(self._turning.at(u).as_matrix(), points)

    @cached_property
    def _turning(self) -> _Turning:
        return _Turning(self.start, self.end)


class TcpArc:
    """Arc through three points; the orientation turns evenly from the first to the last."""

    def __init__(self, start: FloatArray, via: FloatArray, end: FloatArray) -> None:
        """Fit the circle.

        Args:
            start: T_base_tool at the start, shape (4, 4).
            via: Pose whose point lies on the arc; its orientation is not used.
            end: T_base_tool at the end.

        Raises:
            ValueError: One of the controller's limits for circles is broken; says which.
        """
        self.start, self.end = start, end
        a, b, c = (pose[:3, 3] for pose in (start, via, end))
        to_via, to_end = b - a, c - a
        for what, chord in (("circle point", to_via), ("end point", to_end)):
            if np.linalg.norm(chord) < SHORTEST_CHORD:
                length = m_to_mm(float(np.linalg.norm(chord)))
                raise ValueError(f"the {what} is {length:.3f} mm from the start, allowed is at least 0.1 mm")
        cosine = to_via @ to_end / np.linalg.norm(to_via) / np.linalg.norm(to_end)
        seen = float(np.arccos(np.clip(cosine, -1.0, 1.0)))
        if seen < SMALLEST_ANGLE or seen > np.pi - 1e-9:
            raise ValueError(
                f"circle point and end are {rad_to_deg(seen):.3f} deg apart seen from the start, "
                "allowed is 1 to 180 deg"
            )
        normal = np.cross(to_via, to_end)
        square = normal @ normal
        centre = a + (
            np.cross(normal, to_via) * (to_end @ to_end) + np.cross(to_end, normal) * (to_via @ to_via)
        ) / (2.0 * square)
        self._centre = centre
        self.radius = float(np.linalg.norm(a - centre))
        self._x = (a - centre) / self.radius
        self._y = np.cross(normal / np.sqrt(square), self._x)
        self.angle = float(np.mod(np.arctan2(self._y @ (c - centre), self._x @ (c - centre)), 2.0 * np.pi))
        if self.angle > LARGEST_ARC:
            raise ValueError(f"the arc is {rad_to_deg(self.angle):.1f} deg long, allowed are 240 deg")
        self.length = self.radius * self.angle
        self.turn = angle_between(start, end)
        self._turning = _Turning(start, end)

    def poses(self, u: FloatArray) -> FloatArray:
        """T_base_tool, shape (n, 4, 4), at u (n,)."""
        u = np.asarray(u, dtype=float)
        angle = (u * self.angle)[:, None]
        points = self._centre + self.radius * (np.cos(angle) * self._x + np.sin(angle) * self._y)
        return _assemble(self._turning.at(u).as_matrix(), points)


@dataclass(frozen=True, eq=False)
class Corner:
    """Parabola that rounds off the corner between two curves.

    Attributes:
        before: T_base_tool where the first curve is left, shape (4, 4).
        corner: T_base_tool programmed, which the tool cuts off, shape (4, 4).
        after: T_base_tool where the second curve is entered, shape (4, 4).
    """

    before: FloatArray
    corner: FloatArray
    after: FloatArray

    @property
    def length(self) -> float:
        """Length of the two legs, which the parabola is timed by [m]."""
        p, q, r = (pose[:3, 3] for pose in (self.before, self.corner, self.after))
        return float(np.linalg.norm(q - p) + np.linalg.norm(r - q))

    @property
    def turn(self) -> float:
        """Angle turned along the legs [rad]."""
        return angle_between(self.before, self.corner) + angle_between(self.corner, self.after)

    def poses(self, u: FloatArray) -> FloatArray:
        """T_base_tool, shape (n, 4, 4), at u (n,)."""
        u = np.asarray(u, dtype=float)
        p, q, r = (pose[:3, 3] for pose in (self.before, self.corner, self.after))
        w = u[:, None]
        points = (1.0 - w) ** 2 * p + 2.0 * w * (1.0 - w) * q + w**2 * r
        # By way of matrices, which makes the quaternions of unit length again.
        first = Rotation.from_matrix(_Turning(self.before, self.corner).at(u).as_matrix())
        second = Rotation.from_matrix(_Turning(self.corner, self.after).at(u).as_matrix())
        step = Rotation.from_rotvec((second * first.inv()).as_rotvec() * w)
        return _assemble((step * first).as_matrix(), points)


def corner_joints(before: FloatArray, corner: FloatArray, after: FloatArray, u: FloatArray) -> FloatArray:
    """The same parabola over joint angles, for corners at joint motions.

    Args:
        before: Joint angles where the first motion is left, shape (6,) [rad].
        corner: Joint angles at the programmed target, shape (6,) [rad].
        after: Joint angles where the second motion is entered, shape (6,) [rad].
        u: Parameter from 0 to 1, shape (n,).

    Returns:
        Shape (n, 6) [rad].
    """
    w = np.asarray(u, dtype=float)[:, None]
    return (1.0 - w) ** 2 * before + 2.0 * w * (1.0 - w) * corner + w**2 * after


def angle_between(a: FloatArray, b: FloatArray) -> float:
    """Angle by which one pose is turned from another [rad], shapes (4, 4)."""
    return float(np.linalg.norm(Rotation.from_matrix(a[:3, :3].T @ b[:3, :3]).as_rotvec()))


class _Turning:
    """Turning evenly about one axis from one pose to another, spherical linear interpolation."""

    def __init__(self, start: FloatArray, end: FloatArray) -> None:
        """Find the axis between two poses of shape (4, 4)."""
        both = Rotation.from_matrix([start[:3, :3], end[:3, :3]])
        self._first = both[:1]
        self._rotvec = (self._first.inv() * both[1:]).as_rotvec()  # (1, 3) [rad]

    def at(self, u: FloatArray) -> Rotation:
        """Rotations at u (n,), from 0 to 1."""
        share = np.clip(u, 0.0, 1.0)[:, None]
        return self._first * Rotation.from_rotvec(self._rotvec * share)


def _assemble(rotations: FloatArray, points: FloatArray) -> FloatArray:
    """Poses (n, 4, 4) from rotations (n, 3, 3) and points (n, 3) [m]."""
    poses = np.zeros((len(points), 4, 4))
    poses[:, :3, :3] = rotations
    poses[:, :3, 3] = points
    poses[:, 3, 3] = 1.0
    return poses
