"""A milling tool as far as a recipe needs to know it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import StrictBool

from doormill_ros.recipes.quantities import (
    Name,
    Quantity,
    Whole,
)
from doormill_ros.units import deg_to_rad
from doormill_ros.values import Section


@dataclass(frozen=True)
class Tool(Section):
    """A cylindrical mill.

    Attributes:
        name: Name within the recipe.
        diameter: Cutting diameter [m].
        flutes: Number of cutting edges.
        cutting_length: Longest depth that it can cut [m].
        max_spindle_speed: Highest spindle speed [rad/s].
        max_chip_load: Thickest chip an edge may take [m], None when not known.
        min_chip_load: Thinnest chip that an edge cuts instead of rubbing [m], None when not known.
        min_surface_speed: Lowest speed of the edge [m/s], None when not known.
        max_surface_speed: Highest speed of the edge [m/s], None when not known.
        centre_cutting: True where an edge reaches over the centre, so that the mill may go straight down. Any other
            goes down along a ramp or a helix.
        max_ramp: Steepest ramp of such a mill [rad].
    """

    name: Name
    diameter: Annotated[float, Quantity("mm", 2.0, 60.0)]
    flutes: Annotated[int, Whole(1, 8)]
    cutting_length: Annotated[float, Quantity("mm", 1.0, 250.0)]
    max_spindle_speed: Annotated[float, Quantity("rpm", 100.0, 60000.0)]
    max_chip_load: Annotated[float | None, Quantity("mm", 0.001, 5.0)] = None
    min_chip_load: Annotated[float | None, Quantity("mm", 0.001, 5.0)] = None
    min_surface_speed: Annotated[float | None, Quantity("m_min", 10.0, 6000.0)] = None
    max_surface_speed: Annotated[float | None, Quantity("m_min", 10.0, 6000.0)] = None
    centre_cutting: StrictBool = False
    max_ramp: Annotated[float, Quantity("deg", 1.0, 45.0)] = deg_to_rad(25.0)

    @property
    def radius(self) -> float:
        """Half the diameter [m]."""
        return self.diameter / 2.0
