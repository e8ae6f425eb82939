"""A milling tool as far as a recipe needs to know it."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.recipes.fields import NAME, Quantity, Whole, entry


@dataclass(frozen=True)
class Tool:
    """A cylindrical mill.

    Attributes:
        name: Name within the recipe.
        diameter: Cutting diameter [m].
        flutes: Number of cutting edges.
        cutting_length: Longest depth that it can cut [m].
        max_spindle_speed: Highest spindle speed [rad/s].
        max_chip_load: Thickest chip an edge may take [m], None when not known.
    """

    name: str = entry(NAME)
    diameter: float = entry(Quantity("mm", 2.0, 60.0))
    flutes: int = entry(Whole(1, 8))
    cutting_length: float = entry(Quantity("mm", 1.0, 250.0))
    max_spindle_speed: float = entry(Quantity("rpm", 100.0, 60000.0))
    max_chip_load: float | None = entry(Quantity("mm", 0.001, 5.0), default=None)

    @property
    def radius(self) -> float:
        """Half the diameter [m]."""
        return self.diameter / 2.0
