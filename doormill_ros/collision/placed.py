"""A body on a robot's joint, and how far it is from points of that joint's frame."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.collision.skeleton import Skeleton


@dataclass(frozen=True, eq=False)
class Placed:
    """A body on a moving joint (0: none): its name, the joint, and its farthest points in the joint's frame.

    `half` are half its edges along its own axes, those of a capsule 0 but for the third, shape (3,) [m]; `place` is the
    pose of its middle in that frame, shape (4, 4).
    """

    name: str
    joint: int
    corners: FloatArray
    margin: float
    half: FloatArray
    place: FloatArray
    bones: Skeleton

    @functools.cached_property
    def away(self) -> float:
        """How far a body on joint 0 is from the origin of the first joint [m]."""
        return self.distance_from(self.bones.origin)

    @functools.cached_property
    def farthest(self) -> float:
        """How far the farthest point of a body that moves can be from there [m]."""
        return self.bones.farthest(self.joint, self.corners, self.margin)

    @functools.cached_property
    def reach(self) -> FloatArray:
        """How far the farthest point of a body that moves can be from each axis before it, shape (6,) [m]."""
        return self.bones.reach(self.joint, self.corners, self.margin)

    def distance_from(self, point: FloatArray) -> float:
        """How far it is from a point of the joint's frame, shape (3,) [m]; not positive for one inside."""
        own = (point - self.place[:3, 3]) @ self.place[:3, :3]
        return float(np.linalg.norm((np.abs(own) - self.half).clip(0.0))) - self.margin

    def distance_to(self, point: FloatArray) -> float:
        """Of a point from the box round the body along its joint's axes, shape (3,) [m]."""
        outside = np.maximum(self.corners.min(axis=0) - point, point - self.corners.max(axis=0)).clip(0.0)
        return float(np.linalg.norm(outside)) - self.margin
