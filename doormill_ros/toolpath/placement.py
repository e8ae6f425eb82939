"""Does the door stand where the cell can mill it."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.errors import DoorPoseError
from doormill_ros.units import m_to_mm, rad_to_deg

# A door at the very limit must not be lost to the noise of its measurement.
SLACK = 0.0005  #: m
ANGLE_SLACK = 0.002  #: rad
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
    for name, found, allowed, slack in (
        ("y", offset.y, limits.y, SLACK),
        ("z", offset.z, limits.z, SLACK),
    ):
        if abs(found) > allowed + slack:
            raise DoorPoseError(
                f"door {recipe.door_id} stands {m_to_mm(found):+.2f} mm off in {name}, allowed are "
                f"{m_to_mm(allowed):.2f} mm; place it again",
                axis=name,
                found=found,
                allowed=allowed,
            )
    if abs(offset.rotation) > limits.rotation + ANGLE_SLACK:
        raise DoorPoseError(
            f"door {recipe.door_id} stands turned by {rad_to_deg(offset.rotation):+.2f} deg, allowed are "
            f"{rad_to_deg(limits.rotation):.2f} deg; place it again",
            axis="rotation",
            found=offset.rotation,
            allowed=limits.rotation,
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
