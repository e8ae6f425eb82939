"""A milling tool as far as a recipe needs to know it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from doormill_ros.recipes.quantities import (
    Name,
    Quantity,
    Whole,
)
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
    """

    name: Name
    diameter: Annotated[float, Quantity("mm", 2.0, 60.0)]
    flutes: Annotated[int, Whole(1, 8)]
    cutting_length: Annotated[float, Quantity("mm", 1.0, 250.0)]
    max_spindle_speed: Annotated[float, Quantity("rpm", 100.0, 60000.0)]
    max_chip_load: Annotated[float | None, Quantity("mm", 0.001, 5.0)] = None

    @property
    def radius(self) -> float:
        """Half the diameter [m]."""
        return self.diameter / 2.0
