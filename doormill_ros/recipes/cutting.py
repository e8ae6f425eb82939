"""Speeds, feeds and passes of a feature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, cast

from pydantic import model_validator

from doormill_ros.recipes.errors import ConflictingFields, MissingField
from doormill_ros.recipes.quantities import (
    Choice,
    Quantity,
    complaint,
)
from doormill_ros.recipes.tool import Tool
from doormill_ros.values import Section


class Direction(str, Choice):
    """Which way round the contour is milled."""

    CLIMB = "climb"
    CONVENTIONAL = "conventional"


@dataclass(frozen=True)
class Cutting(Section):
    """Speed and feed, given as such or as surface speed and chip load.

    Attributes:
        spindle_speed: Spindle speed [rad/s], or None.
        feed: Feed of the tool centre point [m/s], or None.
        surface_speed: Speed of the cutting edge [m/s], or None.
        chip_load: Feed per edge and revolution [m], or None.
        plunge_feed: Feed along the tool axis [m/s]; None takes half the feed.
    """

    spindle_speed: Annotated[float | None, Quantity("rpm", 100.0, 60000.0)] = None
    feed: Annotated[float | None, Quantity("mm_s", 0.5, 500.0)] = None
    surface_speed: Annotated[float | None, Quantity("m_min", 10.0, 6000.0)] = None
    chip_load: Annotated[float | None, Quantity("mm", 0.001, 5.0)] = None
    plunge_feed: Annotated[float | None, Quantity("mm_s", 0.5, 500.0)] = None

    @model_validator(mode="after")
    def _one_way(self) -> Cutting:
        """Exactly one of the two ways to give the speeds is complete."""
        direct, derived = ("spindle_speed_rpm", "feed_mm_s"), ("surface_speed_m_min", "chip_load_mm")
        values = (self.spindle_speed, self.feed, self.surface_speed, self.chip_load)
        given = [key for key, value in zip((*direct, *derived), values, strict=True) if value is not None]
        if set(given) & set(direct) and set(given) & set(derived):
            found = ", ".join(given)
            raise complaint(
                ConflictingFields,
                f"found {found} together, allowed are spindle_speed_rpm with feed_mm_s or "
                "surface_speed_m_min with chip_load_mm",
                (given[-1],),
                found=found,
            )
        for key in derived if set(given) & set(derived) else direct:
            if key not in given:
                raise complaint(MissingField, "is missing, a value must be given", (key,), found=None)
        return self

    def spindle(self, tool: Tool) -> float:
        """Spindle speed [rad/s]; v = omega d / 2, thesis eq. 3.51."""
        if self.spindle_speed is not None:
            return self.spindle_speed
        return cast(float, self.surface_speed) / tool.radius

    def feed_rate(self, tool: Tool) -> float:
        """Feed [m/s]; chip load times edges times revolutions per second, thesis eq. 3.52."""
        if self.feed is not None:
            return self.feed
        return cast(float, self.chip_load) * tool.flutes * self.spindle(tool) / (2.0 * math.pi)

    def chip(self, tool: Tool) -> float:
        """Feed per edge and revolution [m], thesis eq. 3.52."""
        return self.feed_rate(tool) / (tool.flutes * self.spindle(tool) / (2.0 * math.pi))

    def plunge(self, tool: Tool) -> float:
        """Feed along the tool axis [m/s]."""
        return self.plunge_feed if self.plunge_feed is not None else self.feed_rate(tool) / 2.0


@dataclass(frozen=True)
class Passes(Section):
    """How the depth and the wall are reached.

    Attributes:
        depth_step: Deepest single cut along the tool axis [m].
        finish_allowance: Wood left on the wall for one finishing pass at full depth [m]; 0 for
            no finishing pass, the thesis' way (section 3.9).
    """

    depth_step: Annotated[float, Quantity("mm", 0.5, 100.0)]
    finish_allowance: Annotated[float, Quantity("mm", 0.0, 5.0)] = 0.0
