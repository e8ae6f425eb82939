"""What docs/toolpath.md prints: bounds of the planner, speeds of the shipped doors, what a mill tears out."""

from __future__ import annotations

import math

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.cutting_force import COEFFICIENTS
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.program import Program
from doormill_ros.robot.description import load_robot
from doormill_ros.toolpath.targets.refine import FLAT_ARC
from support.milled_worlds import WORLDS
from support.page_figures import number_of

SPREADS = [material.spread for material in COEFFICIENTS.values()]
SMALLEST_SPREAD, LARGEST_SPREAD = min(SPREADS), max(SPREADS)


def flat_arc() -> float:
    """Height below which an arc becomes lines [m]."""
    return FLAT_ARC * number_of("config/toolpath.yaml#correction.step")


def _speeds() -> list[float]:
    """Of the spindle, in the doors whose forces are computed [rpm]."""
    return [
        feature.cutting.spindle(feature.tool) * 60.0 / (2.0 * math.pi)
        for recipe in shipped_recipes().values()
        if recipe.program is Program.GENERAL
        for feature in recipe.features
    ]


def slowest() -> float:
    """Of the spindle, in the doors whose forces are computed [rpm]."""
    return min(_speeds())


def fastest() -> float:
    """Of the spindle, in the doors whose forces are computed [rpm]."""
    return max(_speeds())


def links_in_doubt() -> float:
    """Standard deviation of the links' masses as a share of them."""
    links = load_robot(load_layout().robot).links
    assert links is not None
    return float((links.std / links.mass).max())


def _torn(feature: str) -> float:
    """What a mill that comes out of the rear face tears out: the whole hole [m^2]."""
    (hole,) = [item for item in shipped_recipes()["standard_door"].features if item.id == feature]
    return math.pi * (hole.shape.width / 2.0) ** 2


def handle_hole() -> float:
    """Torn out of the standard door [m^2]."""
    return _torn("handle_hole")


def cylinder_hole() -> float:
    """Torn out of the standard door [m^2]."""
    return _torn("cylinder_hole")


def springs_off() -> float:
    """By which share the springs of a soft world are softer than believed."""
    return 1.0 - max(WORLDS["springs all soft"].springs)
