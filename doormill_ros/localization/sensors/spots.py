"""Nominal places on the door where a sensor looks or touches."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.sensors.errors import BadSensorFile
from doormill_ros.localization.sensors.faces import OUTWARD
from doormill_ros.recipes.door import DoorSize


@dataclass(frozen=True)
class Spot:
    """A place on one of the three faces.

    Attributes:
        face: The face, a key of `faces.OUTWARD`.
        y: From the hinge edge, or from the far edge [m]; unused on the hinge edge.
        z: Above the bottom edge [m]; unused on the bottom edge.
        depth: Before the rear face [m]; unused on the face.
        far_edge: Whether `y` counts from the far edge.
    """

    face: str
    y: float = 0.0
    z: float = 0.0
    depth: float = 0.0
    far_edge: bool = False

    def place(self, door: DoorSize) -> FloatArray:
        """The spot in door axes [m], shape (3,)."""
        x = 0.0 if self.face == "face" else door.thickness - self.depth
        return np.array([x, door.width - self.y if self.far_edge else self.y, self.z])


def check_faces(spots: tuple[Spot, ...], path: Path) -> None:
    """Refuse a spot on a face that does not exist.

    Raises:
        BadSensorFile: With the number of the spot in the file.
    """
    for i, spot in enumerate(spots):
        if spot.face not in OUTWARD:
            raise BadSensorFile(
                f"{path}: place {i + 1} is on {spot.face!r}, allowed are {', '.join(OUTWARD)}", face=spot.face
            )
