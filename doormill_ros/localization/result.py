"""What a picture tells about the door: the pose, how sure it is, and what it was read from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.empty_clamp.stale_clamp import ClampFit
from doormill_ros.localization.marks.drift import Drift

FREE = (1, 2, 3)  #: of x, y, z and the rotations about them, what the camera sees: y, z, rotation about x


@dataclass(frozen=True, eq=False)
class EdgeTrace:
    """One edge of the door's face as found in the picture.

    Attributes:
        name: "hinge" or "bottom".
        pixels: Sub-pixel edge points u, v [px], shape (n, 2).
        inlier: Which points agree with the line, shape (n,), bool.
        line: Fitted line drawn through the lens, u, v [px], shape (m, 2), from the corner outwards.
        residual: RMS distance of the inliers from the line [m].
        contrast: Step across the edge, inside minus outside [grey levels].
        blur: Standard deviation of the edge's point spread [px].
    """

    name: str
    pixels: FloatArray
    inlier: BoolArray
    line: FloatArray
    residual: float
    contrast: float
    blur: float


@dataclass(frozen=True, eq=False)
class CovarianceParts:
    """What a pose's covariance of y, z [m] and rotation [rad] comes from; each part of shape (3, 3).

    Attributes:
        scatter: What the picture leaves open; differs from picture to picture.
        shape: Edges that are not straight beyond what shows of them; the same in all pictures of a door.
        thickness: Distance of the face, from the door's thickness and its seat; the same for a door.
        calibration: Mounting and lens of the camera; the same for all doors.
    """

    scatter: FloatArray
    shape: FloatArray
    thickness: FloatArray
    calibration: FloatArray

    @property
    def total(self) -> FloatArray:
        """Their sum, shape (3, 3)."""
        return self.scatter + self.shape + self.thickness + self.calibration


@dataclass(frozen=True, eq=False)
class Localization:
    """The door's pose from one picture.

    Attributes:
        T_base_door: Pose of the door, shape (4, 4).
        offset: Its offset from the nominal place.
        parts: What its covariance comes from.
        residual: RMS distance of the edge points in use from their lines [m].
        inlier_share: Share of the visible edge length that agrees with the lines, 0..1.
        quality: 0..1, how far the picture is from being refused; 1 is best.
        corner: The door's corner in the picture, u, v [px], shape (2,).
        pixel: Size of a pixel on the door's face [m].
        edges: The hinge edge and the bottom edge.
        drift: What the cell's marks say of the camera; None in a cell without.
        clamp: What the background says of the picture of the empty clamp; None without one, or where none is seen.
    """

    T_base_door: FloatArray
    offset: DoorOffset
    parts: CovarianceParts
    residual: float
    inlier_share: float
    quality: float
    corner: FloatArray
    pixel: float
    edges: tuple[EdgeTrace, EdgeTrace]
    drift: Drift | None = None
    clamp: ClampFit | None = None

    @property
    def covariance(self) -> FloatArray:
        """Of offset y, z [m] and rotation [rad], shape (3, 3)."""
        return self.parts.total

    @property
    def whole_covariance(self) -> FloatArray:
        """The same among six degrees of freedom, zero where the camera is blind, shape (6, 6)."""
        whole = np.zeros((6, 6))
        whole[np.ix_(FREE, FREE)] = self.covariance
        return whole

    @property
    def sees(self) -> tuple[bool, ...]:
        """Which of the six degrees of freedom the camera measures."""
        return tuple(row in FREE for row in range(6))

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations of y, z [m] and rotation [rad], shape (3,)."""
        return np.sqrt(np.diag(self.covariance))
