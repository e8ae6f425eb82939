"""Round holes through the door for a handle or a cylinder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import StrictBool

from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.time_budget import TimeBudget
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.quantities import (
    Name,
    Quantity,
)


@dataclass(frozen=True, kw_only=True)
class HandleHole(Feature):
    """A round hole through the face.

    Attributes:
        backset: Distance of the centre from the lock edge [m].
        diameter: Diameter [m].
        from_both_sides: True when, in a cell with a robot on either side, each mills half the
            thickness (thesis appendix A.1); a single robot mills all of it, against a board behind the door.
        lock_case: Identifier of the lock case that the hole leads through, or None.
    """

    kind: ClassVar[str] = "handle_hole"
    budget: ClassVar[TimeBudget | None] = TimeBudget("hole_side")
    sides: ClassVar[tuple[Side, ...]] = (Side.FRONT, Side.REAR)
    across_key: ClassVar[str] = "backset_mm"
    case_key: ClassVar[str] = "lock_case"

    backset: Annotated[float, Quantity("mm", 0.0, 1350.0)]
    diameter: Annotated[float, Quantity("mm", 5.0, 150.0)]
    from_both_sides: StrictBool = False
    lock_case: Name | None = None

    @property
    def belongs_to(self) -> str | None:
        """See the base class."""
        return self.lock_case

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.diameter, self.diameter, self.diameter / 2.0)

    @property
    def through(self) -> bool:
        """See the base class."""
        return True

    @property
    def halved(self) -> bool:
        """See the base class."""
        return self.from_both_sides

    def across(self, door: DoorSize) -> float:
        """See the base class."""
        return door.width - self.backset

    def cut_depth(self, door: DoorSize) -> float:
        """See the base class."""
        return door.thickness
