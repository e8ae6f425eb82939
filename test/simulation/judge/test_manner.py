"""How the mill cut, from its samples alone: ways whose steepness and turn are known by hand, and programs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.frames import transform
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.cutting import Direction
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.door import R_DOOR_FEATURE, Side
from doormill_ros.recipes.program import Program
from doormill_ros.simulation.errors import MilledWrongWay, PlungedDown
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.simulation.judge.manner import bad_cuts, manners
from support import doors
from support.file_run import run_file
from support.flights import flight, straight
from support.judged_doors import RUN_ID, rigid

FRONT, REAR = R_DOOR_FEATURE[Side.FRONT], R_DOOR_FEATURE[Side.REAR]
FAR = transform(translation=[1.6, 0.0, 0.0])
DOOR = doors.door_with("hinge_oblong", 2000, 800, 40)  # 30 x 120 x 5 mm, mill 16 mm
HINGE = DOOR.features[0]
MIDDLE = np.array([0.0, 0.025, 0.5])  # in the surface, door frame
SHIPPED = {name: r for name, r in shipped_recipes().items() if r.program is Program.GENERAL}
SETUP, CELL = rigid(load_setup()), load_cell()


def of(recipe, **tool):
    """The recipe with other facts about its tools."""
    features = tuple(replace(f, tool=replace(f.tool, **tool)) for f in recipe.features)
    return replace(recipe, features=features)


def manner(*corners, door=DOOR):
    """Of a tool that goes straight through corners (depth, across, up) [mm] from the middle of the hinge."""
    tips = straight(*(MIDDLE + 1e-3 * np.array(corner) for corner in corners), step=2e-3)
    (found,) = manners(door, FAR, flight(FAR, tips, FRONT, HINGE.id))
    return found


def around(sense, inset=0.008, depth=0.005):
    """Round the wall of the hinge, 1 the way its outline runs (clockwise seen from within the wood), -1 the other."""
    ring = HINGE.outline(inset=inset).points(step=5e-4)[::sense]
    ring = np.concatenate([ring, ring[:1]])
    way = np.column_stack([np.full(len(ring), depth), ring[:, 0], ring[:, 1]])
    tips = MIDDLE + np.concatenate([[way[0] - [0.03, 0.0, 0.0]], way, [way[0] - [0.03, 0.0, 0.0]]])
    return flight(FAR, tips, FRONT, HINGE.id)


@pytest.mark.parametrize("beside", [(5, 0), (-5, 0), (0, 5), (0, -5)], ids=str)
def test_straight_down_where_the_mill_was_before_takes_nothing(beside):
    across, up = beside
    far = 5.0 / math.tan(math.radians(10.0))
    again = [-5, across, far + up], [5, across, far + up]
    found = manner([-5, 0, -far], [5, 0, far], [-5, 0, far], *again)
    assert math.degrees(found.steepest) == pytest.approx(10.0, abs=0.1)


@pytest.mark.parametrize("degrees", [3.0, 10.0, 20.0, 45.0])
def test_the_slope_of_a_ramp_is_read_from_the_samples(degrees):
    up = 5.0 / math.tan(math.radians(degrees))
    found = manner([-5, 0, -40 - up], [5, 0, -40 + up], [5, 0, 40])
    assert math.degrees(found.steepest) == pytest.approx(degrees, abs=0.1)


def test_straight_down_is_90_degrees_and_flat_is_none():
    assert math.degrees(manner([-5, 0, 0], [5, 0, 0], [5, 0, 40]).steepest) == pytest.approx(90.0)
    # In from the edge of the door, as flat as can be.
    assert math.degrees(manner([5, -45, 0], [5, 0, 0]).steepest) == pytest.approx(0.0, abs=1e-6)


def test_down_where_nothing_is_left_is_no_plunge():
    ramp = [-1, 0, -40], [5, 0, -20], [5, 0, 20]
    again = [-10, 0, 20], [-10, 0, 0], [5, 0, 0], [5, 0, 10]
    assert math.degrees(manner(*ramp, *again).steepest) < 20.0
    deeper = [-10, 0, 20], [-10, 0, 0], [5.5, 0, 0], [5.5, 0, 10]
    assert math.degrees(manner(*ramp, *deeper).steepest) == pytest.approx(90.0)


def test_beside_what_is_cleared_it_is_one():
    """Half the mill hangs over cleared wood, its middle does not."""
    ramp = [-1, 0, -40], [5, 0, -20], [5, 0, 20]
    assert math.degrees(manner(*ramp, [-10, 0, 20], [-10, 0, 40], [5, 0, 40]).steepest) == pytest.approx(90.0)


@pytest.mark.parametrize(("sense", "climb"), [(1, 1.0), (-1, 0.0)])
def test_the_way_round_is_seen(sense, climb):
    """The outline runs clockwise seen from within the wood, counter-clockwise from behind the spindle: climbing."""
    (found,) = manners(DOOR, FAR, around(sense))
    assert found.climb == pytest.approx(climb, abs=0.02)
    other = replace(DOOR, features=(replace(HINGE, direction=Direction.CONVENTIONAL),))
    for door, asked in ((of(DOOR, centre_cutting=True), 1.0), (of(other, centre_cutting=True), 0.0)):
        bad = bad_cuts(door, FAR, around(sense))
        assert [cut.steep for cut in bad] == ([] if climb == asked else [False])


def test_from_the_far_side_it_is_seen_too():
    hole = doors.door_with("handle_hole", 2000, 800, 40)
    feature = hole.features[0]
    ring = feature.outline(inset=feature.tool.radius).points(step=5e-4)
    centre = np.array([0.0, 0.75, feature.height])
    for rotation, sense, depth, out in ((FRONT, 1, 0.021, -0.03), (REAR, -1, 0.019, 0.07)):
        # Seen from the rear what ran one way runs the other, so the way back climbs there.
        tips = np.column_stack([np.full(len(ring), depth), ring[::sense, 0], ring[::sense, 1]]) + centre
        tips = np.concatenate([[[out, *tips[0, 1:]]], tips, [tips[0]]])
        (found,) = manners(hole, FAR, flight(FAR, tips, rotation, feature.id))
        assert found.climb == pytest.approx(1.0, abs=0.02)
        assert math.degrees(found.steepest) == pytest.approx(90.0)


def test_an_untouched_wall_gives_no_verdict():
    found = manner([-1, 0, -40], [5, 0, -20], [5, 0, 20])
    assert math.isnan(found.climb)
    assert (
        bad_cuts(DOOR, FAR, flight(FAR, straight(MIDDLE, MIDDLE - 0.01 * FRONT[:, 2]), FRONT, HINGE.id)) == []
    )


def run_of(recipe):
    T_base_door = SETUP.layout.T_base_door(recipe.width, recipe.thickness)
    text = render_target_file(plan(recipe, T_base_door, SETUP).program, RUN_ID).decode("ascii")
    executed, turned = run_file(text)
    return T_base_door, executed, turned


@pytest.mark.parametrize("name", SHIPPED)
def test_straight_down_with_a_mill_that_cannot_fails_the_run(name):
    T_base_door, executed, turned = run_of(of(SHIPPED[name], centre_cutting=True))
    verdict = judge(of(SHIPPED[name], centre_cutting=False), T_base_door, executed, CELL, turned)
    assert isinstance(verdict.error, PlungedDown)
    assert {cut.feature for cut in verdict.bad} == {f.id for f in SHIPPED[name].features}
    assert "went down at 90 deg where 25 are allowed" in verdict.sentence


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("direction", Direction)
def test_the_cure_goes_down_as_the_tool_may_and_round_as_the_recipe_says(name, direction):
    recipe = of(SHIPPED[name], centre_cutting=False)
    recipe = replace(recipe, features=tuple(replace(f, direction=direction) for f in recipe.features))
    T_base_door, executed, turned = run_of(recipe)
    assert judge(recipe, T_base_door, executed, CELL, turned).error is None
    for found in manners(recipe, T_base_door, executed):
        assert (
            math.radians(5.0)
            < found.steepest
            < recipe.feature(found.feature).tool.max_ramp + math.radians(0.5)
        )
        assert found.climb == pytest.approx(1.0 if direction is Direction.CLIMB else 0.0, abs=0.05)
    other = next(d for d in Direction if d is not direction)
    turned_round = replace(recipe, features=tuple(replace(f, direction=other) for f in recipe.features))
    error = judge(turned_round, T_base_door, executed, CELL, turned).error
    assert isinstance(error, MilledWrongWay)
    assert f"{other.value} milling was asked for" in error.message
