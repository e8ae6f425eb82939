"""Does the door stand where the cell can mill it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import SENSOR_SLACK, CellLayout
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.errors import DoorPoseError
from doormill_ros.units import m_to_mm, rad_to_deg

CLAMPED = 0.001  #: what the clamp leaves of the other three degrees of freedom [m] and [rad]


def check_placement(T_base_door: FloatArray, recipe: Recipe, layout: CellLayout) -> None:
    """Refuse a door beyond the placement limits, or out of its clamp.

    Args:
        T_base_door: Where the door stands, shape (4, 4).
        recipe: Its size.
        layout: The clamp and the limits.

    Raises:
        DoorPoseError: The door is displaced too far, or along a direction that the clamp holds.
    """
    offset, limits = layout.offset_of(T_base_door, recipe.width), layout.limits
    for axis in limits.beyond(offset, SENSOR_SLACK):
        found, allowed = getattr(offset, axis), getattr(limits, axis)
        off = (
            f"turned by {rad_to_deg(found):+.2f} deg, allowed are {rad_to_deg(allowed):.2f} deg"
            if axis == "rotation"
            else f"{m_to_mm(found):+.2f} mm off in {axis}, allowed are {m_to_mm(allowed):.2f} mm"
        )
        raise DoorPoseError(
            f"door {recipe.door_id} stands {off}; place it again", axis=axis, found=found, allowed=allowed
        )
    clamped = layout.T_base_door(recipe.width, recipe.thickness, offset)
    tilt = float(np.abs(T_base_door[:3, :3] - clamped[:3, :3]).max())
    shift = float(T_base_door[0, 3] - clamped[0, 3])
    if max(abs(shift), tilt) > CLAMPED:
        raise DoorPoseError(
            f"door {recipe.door_id} stands {m_to_mm(shift):+.2f} mm off in x and tilted by {tilt:.4f} rad, allowed "
            f"are {m_to_mm(CLAMPED):.2f} mm and {CLAMPED:.4f} rad; close the clamp",
            axis="x",
            found=shift,
            allowed=CLAMPED,
        )
