"""What docs/recipes.md prints: turns and feeds that follow from the thesis' ranges."""

from __future__ import annotations

import math

from doormill_ros.recipes.cutting_advice import WOOD
from doormill_ros.recipes.documents import load_recipe

_MILL = load_recipe("thesis_190_0deg").features[0].tool
_A_MINUTE = 60.0 / (2.0 * math.pi)  # rad/s to rpm

SLOWEST_IN_WOOD, FASTEST_IN_WOOD = (speed * _A_MINUTE for speed in WOOD)
DIAMETER = _MILL.diameter


def turns_at_the_fastest_edge() -> float:
    """Of the thesis' mill, at the largest speed of the edge that section 3.9 gives [rpm]."""
    return _MILL.max_surface_speed / _MILL.radius * _A_MINUTE


def feed_at_the_thinnest_chip() -> float:
    """At the smallest chip that section 3.9 gives and the slowest spindle for wood [m/s]."""
    return _MILL.min_chip_load * _MILL.flutes * SLOWEST_IN_WOOD / 60.0
