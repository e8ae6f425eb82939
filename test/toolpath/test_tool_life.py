"""Tools of the table: they mill as the recipe's own do, and are refused where they would be worn in the middle."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.toolpath.errors import ToolLengthError, ToolLifeError
from doormill_ros.toolpath.mills.tool_life import cut_lengths
from doormill_ros.toolpath.settings import load_settings

NOSE = load_settings().approach.nose
RUN = "20261122T002931290381Z"


def tabled(recipe, life=1000.0, cut=0.0, length=NOSE):
    """The recipe with its tools out of a table, as a database hands it to the nodes."""
    features = []
    for feature in recipe.features:
        figures = {item.name: getattr(feature.tool, item.name) for item in fields(feature.tool)}
        tool = TabledTool(**figures, length=length, stiffness=1e6, life=life, cut=cut)
        features.append(replace(feature, tool=tool))
    return Recipe.from_document(replace(recipe, features=tuple(features)).to_document())


@pytest.mark.parametrize("name", ["thesis_190_2deg", "nine_point_door"])
def test_the_target_file_is_the_same_byte_by_byte(cell, name):
    own = load_recipe(name)
    files = [
        render_target_file(cell.program(recipe, cell.placed(recipe)), RUN)
        for recipe in (own, tabled(own, cut=3.0))
    ]
    assert files[0] == files[1]


def test_a_thesis_door_cuts_two_contours(cell):
    # Two oblong hinges, 120 mm by 30 mm, round which the middle of a 19 mm mill goes once.
    straight, turn = 2 * (0.120 - 0.030), math.pi * (0.030 - 0.019)
    recipe = tabled(load_recipe("thesis_190_0deg"))
    program = cell.program(recipe, cell.placed(recipe))
    assert cut_lengths(program, recipe) == pytest.approx({"mill_19": 2 * (straight + turn)}, rel=1e-9)
    own = load_recipe("thesis_190_0deg")
    assert cut_lengths(program, own) == {}


def test_a_tool_must_last_for_the_whole_door(cell):
    recipe = load_recipe("thesis_190_0deg")
    T = cell.placed(recipe)
    needs = 2 * (2 * 0.090 + math.pi * 0.011)
    assert cell.program(tabled(recipe, life=100.0, cut=100.0 - needs - 1e-3), T).targets
    with pytest.raises(
        ToolLifeError, match=r"0.43 m of cut with tool 'mill_19', allowed are 0.42 m.*renew"
    ) as caught:
        cell.program(tabled(recipe, life=100.0, cut=100.0 - needs + 0.01), T)
    assert caught.value.data["found"] == pytest.approx(needs)
    with pytest.raises(ToolLifeError, match=r"allowed are 0.00 m"):
        cell.program(tabled(recipe, life=100.0, cut=200.0), T)


@pytest.mark.parametrize("off", [-0.0006, 0.0006])
def test_a_tool_must_be_as_long_as_the_robot_was_told(cell, off):
    recipe = load_recipe("thesis_190_0deg")
    T = cell.placed(recipe)
    assert cell.program(tabled(recipe, length=NOSE + 0.5 * off), T).targets
    with pytest.raises(
        ToolLengthError, match=r"hinge_1: tool 'mill_19' stands 1.* mm out of the spindle, allowed"
    ):
        cell.program(tabled(recipe, length=NOSE + off), T)
