"""The mortise that takes a lock case, milled into the lock edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.fields import Quantity, entry
from doormill_ros.recipes.outline import RoundedRectangle


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

    offset: float | None = entry(Quantity("mm", 0.0, 100.0), default=None)
    width: float = entry(Quantity("mm", 5.0, 100.0))
    length: float = entry(Quantity("mm", 5.0, 600.0))
    depth: float = entry(Quantity("mm", 0.5, 200.0))

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

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, min(self.width, self.length) / 2.0)
