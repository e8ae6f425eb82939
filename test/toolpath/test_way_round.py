"""Where the way round an edge of the door is out of reach and the feature is not, the robot goes by joint space."""

from __future__ import annotations

from dataclasses import replace

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.pipeline.plan import load_setup
from doormill_ros.recipes.documents import parse_yaml
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.judge.bodies import load_cell
from support.judged_doors import judge_door, rigid
from support.source_tree import ROOT

DOOR = ROOT / "test" / "data" / "wide_lock_door.yaml"


def test_a_lock_is_reached_through_joint_space_and_nothing_is_touched() -> None:
    recipe = Recipe.from_document(parse_yaml(DOOR.read_text(encoding="utf-8")))
    setup = rigid(load_setup())
    checks = replace(setup.settings.checks, tools=2)  # both stand in the same place: what is asked is the way
    setup = replace(setup, settings=replace(setup.settings, checks=checks))
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    outcome = judge_door(recipe, T_base_door, DoorOffset(), setup, load_cell())
    assert outcome.refusal is None, outcome.refusal
    assert outcome.verdict is not None
    assert outcome.verdict.error is None, outcome.verdict.sentence
