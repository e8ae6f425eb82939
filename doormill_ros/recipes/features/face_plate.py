"""The shallow recess for the face plate of a lock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from doormill_ros.recipes.features.lock_case import LOCK_TIME, EdgePocket
from doormill_ros.recipes.features.time_budget import TimeBudget
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.quantities import (
    Name,
    Quantity,
)


@dataclass(frozen=True, kw_only=True)
class FacePlate(EdgePocket):
    """A face-plate recess round the mouth of a lock case.

    Attributes:
        corner_radius: Radius of the corners [m].
        lock_case: Identifier of the lock case whose mouth it surrounds, or None.
    """

    kind: ClassVar[str] = "face_plate"
    budget: ClassVar[TimeBudget | None] = LOCK_TIME
    surrounds: ClassVar[bool] = True
    radius_key: ClassVar[str] = "corner_radius_mm"
    case_key: ClassVar[str] = "lock_case"

    corner_radius: Annotated[float, Quantity("mm", 0.0, 50.0)]
    lock_case: Name | None = None

    @property
    def belongs_to(self) -> str | None:
        """See the base class."""
        return self.lock_case

    @property
    def shape(self) -> RoundedRectangle:
        """See the base class."""
        return RoundedRectangle(self.width, self.length, self.corner_radius)
