"""Every door that ships, and some that nobody foresaw: no motion touches anything but the wood to be cut."""

import math

import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.errors import DoormillError
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judge import judge
from support.file_run import run_file
from support.judged_doors import RUN_ID, judge_doors, rigid

SHIPPED = shipped_recipes()
PLACES = (DoorOffset(), DoorOffset(-0.010, 0.010, math.radians(2.0)))
SETUP, CELL = rigid(load_setup()), load_cell()


def test_seven_doors_ship():
    assert len(SHIPPED) == 7


@pytest.mark.parametrize("place", PLACES, ids=["in its place", "displaced"])
@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_door_is_milled_without_a_touch(name, place):
    recipe = SHIPPED[name]
    T_base_door = SETUP.layout.T_base_door(recipe.width, recipe.thickness, place)
    text = render_target_file(plan(recipe, T_base_door, SETUP).program, RUN_ID).decode("ascii")
    executed, turned = run_file(text)
    verdict = judge(recipe, T_base_door, executed, CELL, turned)
    assert verdict.judged == len(executed) > 1000
    assert verdict.touched_samples == 0, verdict.sentence


def test_what_is_accepted_of_any_doors_touches_nothing():
    outcomes = list(judge_doors(10, 7, 9))
    assert len(outcomes) == 10
    accepted = [outcome for outcome in outcomes if outcome.refusal is None]
    assert len(accepted) >= 1
    assert [outcome.verdict.sentence for outcome in accepted if outcome.verdict.error is not None] == []
    assert all(isinstance(o.refusal, DoormillError) for o in outcomes if o not in accepted)
