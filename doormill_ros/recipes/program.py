"""Which program of the robot mills a door, and what a door must be for the thesis' one."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.recipes.cutting import Direction
from doormill_ros.recipes.door import Side
from doormill_ros.recipes.errors import UnfitForProgram
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.hinge_pocket import OblongHinge, OutlinePoints
from doormill_ros.recipes.quantities import Choice

HINGES = 2


class Program(str, Choice):
    """A program of the robot.

    GENERAL mills any number of features with as many targets as the tolerance needs. PATH_20 is the
    thesis' (figures 3.36 to 3.41): two hinges and 14 targets, each with one pose for all the loads
    under which it is passed.
    """

    GENERAL = "general"
    PATH_20 = "path_20"


def fits_path_20(features: Sequence[Feature]) -> bool:
    """True for what Path_20 can mill: two oblong hinges of six points, each in one pass."""
    return len(features) == HINGES and all(_is_thesis_hinge(feature) for feature in features)


def check_program(program: Program, features: Sequence[Feature]) -> None:
    """Refuse Path_20 for another door than its own.

    Raises:
        UnfitForProgram: The recipe asks for Path_20, which cannot mill it.
    """
    if program is Program.PATH_20 and not fits_path_20(features):
        raise UnfitForProgram(
            "program",
            f"found {Program.PATH_20.value!r}, which mills two oblong hinges of six points on the front, longer "
            "than wide and at most two tools wide, by climb milling in one pass without finish allowance; "
            f"allowed for other features is {Program.GENERAL.value!r}",
            found=Program.PATH_20.value,
        )


def _is_thesis_hinge(feature: Feature) -> bool:
    return (
        isinstance(feature, OblongHinge)
        and feature.points is OutlinePoints.SIX
        and feature.length > feature.width
        and feature.side is Side.FRONT
        and feature.direction is Direction.CLIMB
        and not feature.computes_force
        and feature.passes.finish_allowance == 0.0
        and feature.depth <= feature.passes.depth_step
        and feature.width <= 2.0 * feature.tool.diameter
    )
