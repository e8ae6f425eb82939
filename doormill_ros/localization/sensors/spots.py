"""Nominal places on the door where a sensor looks or touches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import StrictBool

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.sensors.faces import Face
from doormill_ros.recipes.door import DoorSize
from doormill_ros.values import Finite, Section


@dataclass(frozen=True)
class Spot(Section):
    """A place on one of the three faces.

    Attributes:
        face: The face, a key of `faces.OUTWARD`.
        y: From the hinge edge, or from the far edge [m]; unused on the hinge edge.
        z: Above the bottom edge [m]; unused on the bottom edge.
        depth: Before the rear face [m]; unused on the face.
        far_edge: Whether `y` counts from the far edge.
    """

    face: Face
    y: Finite = 0.0
    z: Finite = 0.0
    depth: Finite = 0.0
    far_edge: StrictBool = False

    def place(self, door: DoorSize) -> FloatArray:
        """The spot in door axes [m], shape (3,)."""
        x = 0.0 if self.face == "face" else door.thickness - self.depth
        return np.array([x, door.width - self.y if self.far_edge else self.y, self.z])
