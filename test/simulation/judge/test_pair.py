"""Two robots that milled one door: each is held against the other one where it stands."""

import dataclasses

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.frames import inverse, transform
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.pair import Milled, judge_pair, standing, waiting, waits
from support.file_run import HOME, run_file
from support.judged_doors import RUN_ID, rigid

FIELDS = dataclasses.fields(ExecutedPath)


@pytest.fixture(scope="module")
def door():
    """Recipe, T_cell_door, where the second robot stands, and what the two did."""
    recipe, setup = load_recipe("standard_door"), rigid(load_setup())
    T_cell_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    executed = []
    for robot in ("first", "second"):
        text = render_target_file(plan(recipe, T_cell_door, setup.of(robot)).program, RUN_ID).decode("ascii")
        executed.append(run_file(text)[0])
    return recipe, T_cell_door, setup.settings.second_robot.T_base_second, executed


def milled(door, T_cell_second):
    _, _, _, (first, second) = door
    return [Milled("first", np.eye(4), first), Milled("second", T_cell_second, second)]


def test_what_two_robots_do_is_free_of_touches(door):
    recipe, T_cell_door, T_cell_second, executed = door
    found = judge_pair(recipe, T_cell_door, milled(door, T_cell_second), load_cell())
    assert found.error is None, found.sentence
    assert found.judged == sum(len(path) for path in executed)


def test_a_robot_in_the_space_of_the_other_is_found_and_named(door):
    """The second robot stands 1.9 m nearer than its programs know."""
    recipe, T_cell_door, T_cell_second, _ = door
    near = transform(translation=[-1.9, 0.0, 0.0]) @ T_cell_second
    found = judge_pair(recipe, T_cell_door, milled(door, near), load_cell())
    mine = {touch.obstacle for touch in found.touches if touch.body.startswith("first's")}
    assert any(obstacle.startswith("second's") for obstacle in mine), mine
    assert found.error is not None


def test_the_planner_keeps_clear_of_the_same_robot_as_the_judge():
    """Boxes of the waiting robot and its rack, as the planner has them and as the judge has them by code of its own."""
    setup, cell, recipe = load_setup(), load_cell(), load_recipe("standard_door")
    T_first_second = setup.settings.second_robot.T_base_second
    racks = {"first": cell.rack_of_second, "second": cell.rack}
    for robot, T_own_other in (("first", T_first_second), ("second", inverse(T_first_second))):
        planned = {
            body.name.removeprefix("other robot's "): body
            for body in setup.of(robot).layout.obstacles
            if body.name.startswith("other robot's ")
        }
        judged = {
            box.name.removeprefix("x's "): box
            for box in (
                *standing(cell, np.radians(HOME), T_own_other, "x", 0.01),
                *waiting(
                    dataclasses.replace(cell, rack=racks[robot]), recipe, "rack_mill_16", T_own_other, "x"
                ),
            )
        }
        assert {"holder of rack_mill_16", "holder of rack_mill_12", "tool rack_mill_12"} <= planned.keys()
        assert planned.keys() == judged.keys() - {"mill"}
        for name, body in planned.items():
            corners = body.corners[np.lexsort(np.round(body.corners, 6).T)]
            signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
            box = judged[name]
            own = (signs * box.half) @ box.at[:3, :3].T + box.at[:3, 3]
            own = own[np.lexsort(np.round(own, 6).T)]
            np.testing.assert_allclose(corners, own, atol=1e-9)


def test_the_second_robot_stands_on_a_pedestal_for_planner_and_judge():
    """In its own base frame it stands as the first one's does; for the first robot it is where the second stands."""
    setup, cell = load_setup(), load_cell()
    T_first_second = setup.settings.second_robot.T_base_second
    planned = {
        robot: {body.name: body for body in setup.of(robot).layout.obstacles} for robot in ("first", "second")
    }
    mine, beyond = (planned[robot]["second pedestal"] for robot in ("second", "first"))
    own = planned["first"]["pedestal"]
    np.testing.assert_allclose(mine.T_frame_body, own.T_frame_body, atol=1e-12)
    np.testing.assert_allclose(mine.size, own.size)
    np.testing.assert_allclose(beyond.T_frame_body, T_first_second @ own.T_frame_body, atol=1e-12)
    (judged,) = (box for box in cell.of_two(T_first_second).obstacles if box.name == "second pedestal")
    np.testing.assert_allclose(judged.at, beyond.T_frame_body, atol=1e-12)
    np.testing.assert_allclose(2.0 * judged.half, own.size)


def test_an_arm_in_the_pedestal_of_the_second_robot_is_told(door):
    """The second robot ends with its arm laid down behind it, where its own pedestal stands."""
    recipe, T_cell_door, T_cell_second, (first, second) = door
    q = second.q.copy()
    q[-1] = np.radians([157.0, 82.0, 50.0, 0.0, 0.0, 0.0])
    laid = dataclasses.replace(second, q=q)
    robots = [Milled("first", np.eye(4), first), Milled("second", T_cell_second, laid)]
    found = judge_pair(recipe, T_cell_door, robots, load_cell())
    assert "second pedestal" in {touch.obstacle for touch in found.touches}
    without = dataclasses.replace(load_cell(), with_second=())
    assert "second pedestal" not in {
        touch.obstacle for touch in judge_pair(recipe, T_cell_door, robots, without).touches
    }


@pytest.mark.parametrize("idle", ["first", "second"])
def test_a_robot_with_nothing_to_mill_is_in_the_way_where_it_stands_at_home(door, idle):
    """It moves not at all; 2.6 m nearer to each other than the program knows they meet."""
    recipe, T_cell_door, T_cell_second, executed = door
    for shift, free in ((0.0, True), (-2.6, False)):
        near = transform(translation=[shift, 0.0, 0.0]) @ T_cell_second
        robots = [Milled("first", np.eye(4), executed[0]), Milled("second", near, executed[1])]
        robots = [dataclasses.replace(own, executed=None) if own.robot == idle else own for own in robots]
        found = judge_pair(recipe, T_cell_door, robots, load_cell())
        met = {touch.obstacle for touch in found.touches if touch.obstacle.startswith(f"{idle}'s")}
        assert (met == set()) == free, met
        assert found.judged == len(executed[idle == "first"])


def test_a_robot_that_tells_of_no_motion_stands_at_home_with_its_first_tool(door):
    """Robot and rack as they wait between doors, the same as of one that has told where it began."""
    *_, (first, _) = door
    cell = load_cell()
    home, carried = waits(Milled("first", np.eye(4), None), cell, 0)
    np.testing.assert_allclose(home, np.radians(HOME), atol=1e-9)
    assert carried == cell.rack[0].tool
    values = {field.name: getattr(first, field.name) for field in FIELDS}
    none = ExecutedPath(**{name: value if value is None else value[:0] for name, value in values.items()})
    np.testing.assert_array_equal(waits(Milled("first", np.eye(4), none), cell, -1)[0], home)
    np.testing.assert_allclose(waits(Milled("first", np.eye(4), first), cell, 0)[0], home, atol=1e-6)
