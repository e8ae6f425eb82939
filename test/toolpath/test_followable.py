"""A path that a controller can follow: judged from the target file alone, see `support.path_rules`."""

import math
from dataclasses import replace

import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.errors import DoormillError
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.program import Program
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.toolpath.settings import load_settings
from support.judged_doors import RUN_ID, draw
from support.path_rules import path_faults

SHIPPED = {name: r for name, r in shipped_recipes().items() if r.program is Program.GENERAL}
PLACES = (DoorOffset(), DoorOffset(-0.010, 0.010, math.radians(2.0)))
ACCELERATION = ControllerLimits().acceleration
RANDOM_DOORS = 16
BACK = 164.0  #: degrees; a tool that turns back on its own track has to stop


def faults(program):
    return path_faults(render_target_file(program, RUN_ID).decode("ascii"), ACCELERATION)


def has_to_stop(recipe, name):
    """Its wall's corners leave the tool less than the 0.1 mm that a MoveC needs, or the outline leaves it no room."""
    feature = next(f for f in recipe.features if f.id == name)
    shape, radius = feature.shape, feature.tool.radius
    return shape.radius < radius + 1e-4 or min(shape.width, shape.length) / 2.0 - radius < 1e-3


@pytest.fixture(scope="module", params=SHIPPED)
def standing(request, cell):
    recipe = SHIPPED[request.param]
    T_base_door = cell.layout.T_base_door(recipe.width, recipe.thickness, PLACES[1])
    return recipe, cell.program(recipe, T_base_door)


@pytest.mark.parametrize("place", PLACES, ids=["in its place", "displaced"])
@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_door_is_cut_without_short_motions_tight_bends_and_stops(cell, name, place):
    recipe = SHIPPED[name]
    found = faults(cell.program(recipe, cell.layout.T_base_door(recipe.width, recipe.thickness, place)))
    assert (found.short, found.tight, found.stops) == ([], [], [])


def test_any_door_is(cell):
    """Whose square corners alone are stopped at."""
    plain = load_settings()
    settings = replace(plain, checks=replace(plain.checks, tools=9.0))
    looked_at = 0
    for recipe, place in draw(RANDOM_DOORS, 11):
        try:
            T_base_door = cell.layout.T_base_door(recipe.width, recipe.thickness, place)
            program = cell.program(recipe, T_base_door, settings=settings)
        except DoormillError:
            continue
        looked_at += 1
        found = faults(program)
        assert (found.short, found.tight) == ([], [])
        stopped = {program.motions[number].feature for number, turn in found.stops if turn < BACK}
        wrong = [f for f in recipe.features if f.id in stopped and not has_to_stop(recipe, f.id)]
        assert wrong == [], [(f.shape, f.tool.radius, stop) for f in wrong for stop in found.stops]
    assert looked_at > RANDOM_DOORS / 4


def test_the_judge_sees_what_it_looks_for(standing):
    """Ten times the feed is too fast for the bends and the motions; a fine point in the wood is a stop."""
    _, program = standing
    fast = tuple(replace(m, speed=10.0 * m.speed) if m.cutting else m for m in program.motions)
    found = faults(replace(program, motions=fast))
    assert found.short
    assert found.in_a_row() > 1
    assert found.tight
    fine = tuple(replace(m, zone="fine") if m.cutting else m for m in program.motions)
    assert len(faults(replace(program, motions=fine)).stops) == sum(m.cutting for m in program.motions)


def test_the_standard_door_needs_a_third_of_the_targets_that_steps_in_the_wrench_took(cell):
    """893 of them, when the wrench went in steps of 0.04 mm of deflection."""
    recipe = SHIPPED["standard_door"]
    program = cell.program(recipe, cell.layout.T_base_door(recipe.width, recipe.thickness, PLACES[1]))
    assert len(program.targets) <= 893 / 3
