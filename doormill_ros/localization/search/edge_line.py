"""A straight candidate for an edge, found to about a pixel, and the corner of two of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.view import HINGE

_DRAWN = 0.05  # length drawn of a line that is only a candidate [m]


@dataclass(frozen=True)
class EdgeLine:
    """A candidate: place at the nominal corner [m], slope across per along, step [grey levels]."""

    across: float
    tilt: float
    step: float

    @classmethod
    def at_pose(cls, edge: str, pose: FloatArray, step: float) -> EdgeLine:
        """The edge of a door at y, z [m] and rotation [rad], shape (3,)."""
        tilt = float(np.tan(pose[2]))
        if edge == HINGE:
            return cls(float(pose[0] + tilt * pose[1]), -tilt, step)
        return cls(float(pose[1] - tilt * pose[0]), tilt, step)

    def at(self, along: float) -> float:
        """Its place across the edge at a distance along it [m]."""
        return self.across + self.tilt * along

    def moved(self, by: float) -> EdgeLine:
        """The same so much further across [m]."""
        return replace(self, across=self.across + by)

    def points(self, edge: str, start: float) -> FloatArray:
        """Two face points (2, 2) on it, from a distance along the edge inwards [m]."""
        along = np.array([start, start + _DRAWN])
        pair = [self.across + self.tilt * along, along]
        return np.stack(pair if edge == HINGE else pair[::-1], axis=-1)


def meet(hinge: EdgeLine, bottom: EdgeLine) -> FloatArray:
    """Pose (y, z, rotation) of the corner of two lines; the rotation is the mean of theirs."""
    # Hinge: y = a + p z, bottom: z = b + q y; a turn by r tilts them by -r and +r.
    y = (hinge.across + hinge.tilt * bottom.across) / (1 - hinge.tilt * bottom.tilt)
    return np.array([y, bottom.across + bottom.tilt * y, np.arctan((bottom.tilt - hinge.tilt) / 2)])
