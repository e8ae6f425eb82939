"""Where the way round an edge of the door is out of reach and the feature is not, the robot goes by joint space.

Where no one posture of the arm serves all features, it turns over between them.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.pipeline.plan import load_setup
from doormill_ros.recipes.documents import parse_yaml
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.units import DEG
from support.judged_doors import Outcome, judge_door, rigid
from support.source_tree import ROOT

DATA = ROOT / "test" / "data"


def milled(file: str, offset: DoorOffset) -> Outcome:
    recipe = Recipe.from_document(parse_yaml((DATA / file).read_text(encoding="utf-8")))
    setup = rigid(load_setup())
    checks = replace(setup.settings.checks, tools=2)  # both stand in the same place: what is asked is the way
    setup = replace(setup, settings=replace(setup.settings, checks=checks))
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
    return judge_door(recipe, T_base_door, offset, setup, load_cell())


@pytest.mark.parametrize(
    ("file", "offset"),
    [
        ("wide_lock_door.yaml", DoorOffset()),
        ("high_lock_door.yaml", DoorOffset(rotation=-2.0 * DEG)),
        ("high_lock_door.yaml", DoorOffset(y=-0.01, z=-0.01, rotation=-2.0 * DEG)),
    ],
)
def test_a_lock_is_reached_through_joint_space_and_nothing_is_touched(file: str, offset: DoorOffset) -> None:
    outcome = milled(file, offset)
    assert outcome.refusal is None, outcome.refusal
    assert outcome.verdict is not None
    assert outcome.verdict.error is None, outcome.verdict.sentence
