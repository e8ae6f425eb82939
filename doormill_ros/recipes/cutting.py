"""Speeds, feeds and passes of a feature."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

from doormill_ros.recipes.errors import ConflictingFields, MissingField
from doormill_ros.recipes.fields import Quantity, entry, join
from doormill_ros.recipes.tool import Tool


class Direction(str, Enum):
    """Which way round the contour is milled."""

    CLIMB = "climb"
    CONVENTIONAL = "conventional"


@dataclass(frozen=True)
class Cutting:
    """Speed and feed, given as such or as surface speed and chip load.

    Attributes:
        spindle_speed: Spindle speed [rad/s], or None.
        feed: Feed of the tool centre point [m/s], or None.
        surface_speed: Speed of the cutting edge [m/s], or None.
        chip_load: Feed per edge and revolution [m], or None.
        plunge_feed: Feed along the tool axis [m/s]; None takes half the feed.
    """

    spindle_speed: float | None = entry(Quantity("rpm", 100.0, 60000.0), default=None)
    feed: float | None = entry(Quantity("mm_s", 0.5, 500.0), default=None)
    surface_speed: float | None = entry(Quantity("m_min", 10.0, 6000.0), default=None)
    chip_load: float | None = entry(Quantity("mm", 0.001, 5.0), default=None)
    plunge_feed: float | None = entry(Quantity("mm_s", 0.5, 500.0), default=None)

    @staticmethod
    def check_fields(values: dict[str, Any], path: str) -> None:
        """Exactly one of the two ways to give the speeds is complete.

        Raises:
            ConflictingFields: Values of both ways are given.
            MissingField: Half of a way is missing.
        """
        direct, derived = ("spindle_speed", "feed"), ("surface_speed", "chip_load")
        keys = {
            "spindle_speed": "spindle_speed_rpm",
            "feed": "feed_mm_s",
            "surface_speed": "surface_speed_m_min",
            "chip_load": "chip_load_mm",
        }
        given = [name for name in (*direct, *derived) if values.get(name) is not None]
        if any(n in direct for n in given) and any(n in derived for n in given):
            found = ", ".join(keys[n] for n in given)
            raise ConflictingFields(
                join(path, keys[given[-1]]),
                f"found {found} together, allowed are spindle_speed_rpm with feed_mm_s or "
                "surface_speed_m_min with chip_load_mm",
                found=found,
            )
        wanted = derived if any(n in derived for n in given) else direct
        for name in wanted:
            if name not in given:
                raise MissingField(join(path, keys[name]), "is missing, a value must be given", found=None)

    def spindle(self, tool: Tool) -> float:
        """Spindle speed [rad/s]; v = omega d / 2, thesis eq. 3.51."""
        if self.spindle_speed is not None:
            return self.spindle_speed
        return self.surface_speed / tool.radius

    def feed_rate(self, tool: Tool) -> float:
        """Feed [m/s]; chip load times edges times revolutions per second, thesis eq. 3.52."""
        if self.feed is not None:
            return self.feed
        return self.chip_load * tool.flutes * self.spindle(tool) / (2.0 * math.pi)

    def chip(self, tool: Tool) -> float:
        """Feed per edge and revolution [m], thesis eq. 3.52."""
        return self.feed_rate(tool) / (tool.flutes * self.spindle(tool) / (2.0 * math.pi))

    def plunge(self, tool: Tool) -> float:
        """Feed along the tool axis [m/s]."""
        return self.plunge_feed if self.plunge_feed is not None else self.feed_rate(tool) / 2.0


@dataclass(frozen=True)
class Passes:
    """How the depth and the wall are reached.

    Attributes:
        depth_step: Deepest single cut along the tool axis [m].
        finish_allowance: Wood left on the wall for one finishing pass at full depth [m]; 0 for
            no finishing pass, the thesis' way (section 3.9).
    """

    depth_step: float = entry(Quantity("mm", 0.5, 100.0))
    finish_allowance: float = entry(Quantity("mm", 0.0, 5.0), default=0.0)
