"""The mortise that takes a lock case, milled into the lock edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.time_budget import TimeBudget
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.quantities import (
    Quantity,
)

LOCK_TIME = TimeBudget("lock_case", "lock case")  #: of a lock case and its face plate


@dataclass(frozen=True, kw_only=True)
class EdgePocket(Feature):
    """A pocket in an edge of the door.

    Attributes:
        offset: Distance of the centre from the front face [m]; None puts it in the middle.
        width: Extent across the thickness [m].
        length: Extent along the height [m].
        depth: Depth [m].
    """

    sides: ClassVar[tuple[Side, ...]] = (Side.LOCK_EDGE, Side.HINGE_EDGE)
    across_key: ClassVar[str] = "offset_mm"
    depth_key: ClassVar[str] = "depth_mm"

    offset: Annotated[float | None, Quantity("mm", 0.0, 100.0)] = None
    width: Annotated[float, Quantity("mm", 5.0, 100.0)]
    length: Annotated[float, Quantity("mm", 5.0, 600.0)]
    depth: Annotated[float, Quantity("mm", 0.5, 200.0)]

    def across(self, door: DoorSize) -> float:
        """See the base class."""
        return door.thickness / 2.0 if self.offset is None else self.offset

    def cut_depth(self, door: DoorSize) -> float:
        """See the base class."""
        return self.depth


@dataclass(frozen=True, kw_only=True)
class LockCase(EdgePocket):
    """A lock case mortise: an oblong slot, deep into the edge."""

    kind: ClassVar[str] = "lock_case"
    budget: ClassVar[TimeBudget | None] = LOCK_TIME
    is_lock_case: ClassVar[bool] = True

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, min(self.width, self.length) / 2.0)
