"""A door that was moved by a known step, and what its picture shows."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.sensors.corner_edges import EdgeRays
from doormill_ros.recipes.door import DoorSize


@dataclass(frozen=True, eq=False)
class MovedDoor:
    """One picture of the door.

    Attributes:
        picture: Grey picture, shape (h, w), uint8.
        move: Where the door stood from its reference place, base axes [m], shape (3,).
        door: Its size.
    """

    picture: ByteArray
    move: FloatArray
    door: DoorSize


@dataclass(frozen=True, eq=False)
class SeenDoor:
    """Edges of one picture and where the door stood."""

    edges: list[EdgeRays]
    moved: MovedDoor
    T_base_door: FloatArray
