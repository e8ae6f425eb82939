"""Where a rig is set up for the door to be: its corner, spots on its faces, and whether a door reaches a spot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout

#: Which door coordinate vanishes on each face; the nominal door's axes are those of the base.
FACES = {"face": 0, "hinge": 1, "bottom": 2}


def nominal_corner(layout: CellLayout, width: float, thickness: float) -> FloatArray:
    """Corner of face, hinge edge and bottom in base coordinates, shape (3,) [m].

    Args:
        layout: Where the nominal door stands.
        width: Door width [m].
        thickness: Door thickness [m].
    """
    return np.array([layout.rear_face_x - thickness, layout.centre_y - width / 2, layout.bottom_z])


def spot_on_face(entry: Mapping[str, Any], extent: FloatArray) -> FloatArray:
    """A spot of a sensor's file on the face it names, in door coordinates, shape (3,) [m].

    Args:
        entry: `face`, and `depth` below the face, `y` (from the far edge where `far_edge` says so) and `z` [m].
        extent: Thickness, width and height of the door, shape (3,) [m].
    """
    spot = np.array([extent[0] - entry.get("depth", 0.0), entry.get("y", 0.0), entry.get("z", 0.0)])
    if entry.get("far_edge"):
        spot[1] = extent[1] - spot[1]
    spot[FACES[entry["face"]]] = 0.0
    return spot


def beside(hit: FloatArray, axis: int, extent: FloatArray) -> bool:
    """Whether a point of the plane of a face, shape (3,) [m] in door coordinates, lies beside the door.

    Args:
        hit: The point.
        axis: Coordinate that vanishes on the face.
        extent: Thickness, width and height of the door, shape (3,) [m].
    """
    others = [i for i in range(3) if i != axis]
    return bool(np.any(hit[others] < 0) or np.any(hit[others] > extent[others]))
