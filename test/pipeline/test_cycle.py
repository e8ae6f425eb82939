"""The time of a door: what one robot takes, what the thesis allows, and what two would need."""

from __future__ import annotations

from dataclasses import replace

import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.pipeline.cycle import cycle_time
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.pipeline.preview import preview
from doormill_ros.recipes.documents import load_recipe
from support.file_run import run_file
from support.judged_doors import RUN_ID, rigid

ALLOWED = 80.0  # s, thesis, appendix A.1


def test_of_a_door_that_one_robot_does_not_keep_it_tells_what_two_would_need() -> None:
    recipe = load_recipe("standard_door")
    (alone,) = preview(recipe)
    found = cycle_time(recipe, alone.check.time)
    assert found.allowed == ALLOWED
    assert found.two < found.allowed < found.one
    # The simulated controller moves the slower of the two for less than that, by what it knows nothing of: reading,
    # spindle and finding the door.
    setup = rigid(load_setup())
    T_cell_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    moved = []
    for robot in ("first", "second"):
        text = render_target_file(plan(recipe, T_cell_door, setup.of(robot)).program, RUN_ID).decode("ascii")
        moved.append(run_file(text)[0].time[-1])
    cycle = setup.settings.cycle
    assert max(moved) < found.two - cycle.probing < max(moved) + 12.0
    assert found.sentence.endswith(f"two that mill at once would need {found.two:.1f} s")


def test_a_door_that_one_robot_keeps_needs_no_second() -> None:
    recipe = load_recipe("thesis_190_0deg")
    found = cycle_time(recipe, 30.0)
    assert (found.two, found.reason) == (0.0, "")
    assert found.sentence.endswith("allowed are 80.0 s: kept")


def test_where_two_cannot_mill_the_door_it_says_why() -> None:
    recipe = load_recipe("standard_door")
    through = [replace(f, from_both_sides=False) if f.through else f for f in recipe.features]
    found = cycle_time(replace(recipe, features=tuple(through)), 100.0)
    assert found.two == 0.0
    assert "nothing backs the wood" in found.reason
    assert found.reason in found.sentence


@pytest.mark.parametrize("program", [69.9, 70.1])
def test_the_limit_is_that_of_the_whole_door(program: float) -> None:
    recipe = load_recipe("standard_door")
    assert ("kept" in cycle_time(recipe, program).sentence) == (program < 70.0)
