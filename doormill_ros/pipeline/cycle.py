"""How long a door takes against what appendix A.1 of the thesis allows, and what two robots would need."""

from __future__ import annotations

from doormill_ros.cell.output.summary import CycleTime
from doormill_ros.errors import DoormillError
from doormill_ros.pipeline.preview import preview
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.door_checks import cycle_budget
from doormill_ros.toolpath.settings import load_settings


def cycle_time(recipe: Recipe, program: float) -> CycleTime:
    """The door's time; where one robot does not keep what is allowed, also that of two which mill at once.

    Args:
        recipe: The door.
        program: What one robot's program takes [s].
    """
    cycle = load_settings().cycle
    one = program + cycle.probing
    if one <= cycle.total:
        return CycleTime(one, cycle.total)
    try:
        two = cycle_budget([robot.check for robot in preview(recipe, 2)]).found
    except DoormillError as error:
        return CycleTime(one, cycle.total, reason=error.message)
    return CycleTime(one, cycle.total, two)
