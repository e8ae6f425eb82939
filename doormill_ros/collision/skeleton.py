"""A robot's joints, and how far each of them can move what hangs on it."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross
from doormill_ros.robot.chain import JOINTS

PARALLEL = 1e-9  #: a step less than this beside an axis is on it [m]


@functools.cache
def model_of(urdf: Path) -> pin.Model:
    """Pinocchio's model of a robot."""
    return pin.buildModelFromUrdf(str(urdf))


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A robot's joints.

    Attributes:
        own_axis: Axis of each joint in its own frame, shape (6, 3).
        longest: How far the origin of joint b can be from that of joint a, whatever the angles, shape (6, 6) [m].
        origin: That of the first joint, which stands still, base frame, shape (3,) [m].
        turned: Each joint's place in the frame of the one before it is the sum of these three, the second times the
            sine and the third times the cosine of its angle, shape (3, 6, 4, 4).
    """

    own_axis: FloatArray
    longest: FloatArray
    origin: FloatArray
    turned: FloatArray

    def frames(self, q: FloatArray) -> FloatArray:
        """T_base_joint of base (0) and joints 1 to 6, without the last row, shapes (n, 6) [rad] -> (7, 3, 4, n)."""
        still, by_sine, by_cosine = self.turned
        own = still + np.sin(q)[..., None, None] * by_sine + np.cos(q)[..., None, None] * by_cosine
        T = np.empty((len(q), JOINTS + 1, 4, 4))
        T[:, 0] = np.eye(4)
        for joint in range(JOINTS):
            np.matmul(T[:, joint], own[:, joint], out=T[:, joint + 1])
        return np.ascontiguousarray(T[:, :, :3].transpose(1, 2, 3, 0))

    def farthest(self, joint: int, corners: FloatArray, margin: float) -> float:
        """How far the farthest point of a body can be from `origin` [m]; arguments as of `reach`."""
        far = float(np.linalg.norm(corners, axis=1).max())
        return float(self.longest[0, joint - 1]) + far + margin

    def reach(self, joint: int, corners: FloatArray, margin: float) -> FloatArray:
        """How far the farthest point of a body can be from each axis before it, shape (6,) [m].

        Args:
            joint: That moves it, 1 to 6.
            corners: Points whose hull, widened by the margin, it is, frame of the joint, shape (n, 3) [m].
            margin: [m].
        """
        last = joint - 1
        row = np.zeros(JOINTS)
        far = float(np.linalg.norm(corners, axis=1).max())
        row[:last] = self.longest[:last, last] + far + margin
        aside = np.linalg.norm(cross(corners, self.own_axis[last]), axis=1)
        row[last] = float(aside.max()) + margin
        return row


@functools.cache
def skeleton_of(urdf: Path) -> Skeleton:
    """The joints of a robot."""
    model = model_of(urdf)
    data = model.createData()
    pin.computeJointJacobians(model, data, np.zeros(JOINTS))
    places = [data.oMi[i] for i in range(1, JOINTS + 1)]
    axes = data.J[3:].T  # (6, 3)
    points = np.array([place.translation for place in places])
    own_axis = np.array([place.rotation.T @ axis for place, axis in zip(places, axes, strict=True)])
    longest = np.zeros((JOINTS, JOINTS))
    for a in range(JOINTS):
        for b in range(a + 1, JOINTS):
            longest[a, b] = _longest(points[a : b + 1], axes[a : b + 1])
    placed = np.array([model.jointPlacements[i].homogeneous for i in range(1, JOINTS + 1)])
    return Skeleton(own_axis, longest, points[0], _turned(placed, own_axis))


def _turned(T_before_joint: FloatArray, axis: FloatArray) -> FloatArray:
    """As in `Skeleton`; joints at angle 0, shape (6, 4, 4), and their axes, shape (6, 3)."""
    turned = np.zeros((3, JOINTS, 4, 4))
    along = axis[:, :, None] * axis[:, None, :]
    turned[0, :, :3, :3], turned[0, :, 3, 3] = along, 1.0
    turned[1, :, :3, :3] = cross(axis[:, None], np.eye(3)).swapaxes(1, 2)
    turned[2, :, :3, :3] = np.eye(3) - along
    parts: FloatArray = T_before_joint @ turned
    return parts


def _longest(points: FloatArray, axes: FloatArray) -> float:
    """How far the last of some joints' origins can be from the first, whatever the angles between them [m].

    An origin on the axis of the joint before it is not moved by that joint, so that the two ways add as vectors.
    """
    total, way = 0.0, points[1] - points[0]
    for i in range(1, len(points) - 1):
        step = points[i + 1] - points[i]
        if float(np.linalg.norm(np.cross(step, axes[i]))) < PARALLEL:
            way = way + step
        else:
            total, way = total + float(np.linalg.norm(way)), step
    return total + float(np.linalg.norm(way))
