"""Boards behind a door: what they back, and how the mill may meet them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import transform
from doormill_ros.values import Array, Name, Positive, Section

RIM = 1e-3  #: wood this far about the mill must be backed too [m]
Pair = Annotated[FloatArray, Array((2,))]


@dataclass(frozen=True, eq=False)
class SolidBoard(Section):
    """A board pressed against the rear face; it ends where the door does.

    Attributes:
        name: What it is called in a verdict.
        thickness: [m].
        from_lock_edge: From where to where, counted from the lock edge, shape (2,) [m].
        height: From where to where above the lower end of the door as it stands, shape (2,) [m].
    """

    name: Name
    thickness: Positive
    from_lock_edge: Pair
    height: Pair

    def span(self, size: FloatArray) -> FloatArray:
        """What it covers of the rear face of a door: lowest and highest y and z, shape (2, 2) [m]."""
        first, last = size[1] - self.from_lock_edge[1], size[1] - self.from_lock_edge[0]
        covered = np.array([[first, self.height[0]], [last, self.height[1]]])
        clipped: FloatArray = np.clip(covered, 0.0, size[1:])
        return clipped

    def box(self, size: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Pose of its middle in the door frame, shape (4, 4), and half its extents, shape (3,) [m].

        None where it is nowhere behind the door.
        """
        low, high = self.span(size)
        if not bool((high > low).all()):
            return None
        middle = np.array([size[0] + 0.5 * self.thickness, *(0.5 * (low + high))])
        return transform(translation=middle), np.array([self.thickness, *(high - low)]) / 2.0

    def backs(self, centre: FloatArray, reach: FloatArray, beyond: FloatArray, size: FloatArray) -> BoolArray:
        """Where the wood about a mill that came out of the rear face cannot be torn out, shape (n,).

        Args:
            centre: Of the mill in that face, y and z, shape (n, 2) [m].
            reach: Its radius, shape (n,) [m].
            beyond: How far its tip is behind the face, shape (n,) [m].
            size: Extents of the door, shape (3,) [m].
        """
        low, high = self.span(size)
        around = (reach + RIM)[:, None]
        inside = np.all((centre - around >= low) & (centre + around <= high), axis=1)
        backed: BoolArray = inside & (beyond < self.thickness)
        return backed
