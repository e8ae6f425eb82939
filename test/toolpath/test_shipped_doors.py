"""Every door that ships and is not the thesis' own: milled as its recipe says, by one robot and by two."""

import math

import pytest

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.recipes.program import Program
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split

SHIPPED = shipped_recipes()
OTHERS = [name for name, recipe in SHIPPED.items() if recipe.program is Program.GENERAL]
PLACEMENTS = [(0.0, 0.0, 0.0), (-0.010, 0.010, math.radians(2.0)), (0.010, -0.010, math.radians(-2.0))]


def test_every_kind_of_feature_ships():
    features = [feature for recipe in SHIPPED.values() for feature in recipe.features]
    assert {feature.kind for feature in features} == set(FEATURES)
    assert {f.points.value for f in features if f.kind == "hinge_oblong"} == {6, 9}
    assert any(f.passes.finish_allowance > 0.0 for f in features)
    assert len(OTHERS) == 3


@pytest.fixture(scope="module", params=[(name, place) for name in OTHERS for place in PLACEMENTS])
def door(request, cell):
    name, place = request.param
    T_base_door = cell.T_base_door(SHIPPED[name], *place)
    return SHIPPED[name], T_base_door, cell.program(SHIPPED[name], T_base_door)


def test_it_is_milled_within_what_was_expected_of_it(cell, door):
    recipe, T_base_door, program = door
    part = inspect(recipe, T_base_door, cell.execute(program, cell.springs))
    assert [result.feature for result in part.features] == [feature.id for feature in recipe.features]
    for result in part.features:
        assert result.milled
        assert result.max_deviation < expected(program, result.feature) + 2e-5, result.feature
        assert result.max_deviation < 1.5e-4
        assert result.uncleared < 1e-9


def expected(program, feature):
    """The largest expected error of the feature's walls; the bend between two targets comes on top of it."""
    return max(program.targets[m.target].expected_error for m in program.motions if m.feature == feature)


def test_without_correction_it_is_worse(cell, door):
    recipe, T_base_door, program = door
    paths = [cell.execute(program, cell.springs, corrected=corrected) for corrected in (True, False)]
    corrected, plain = (inspect(recipe, T_base_door, path).max_deviation for path in paths)
    assert corrected < plain


@pytest.mark.parametrize("name", OTHERS)
def test_two_robots_mill_it_too(cell, name):
    recipe = SHIPPED[name]
    shares = split(recipe, cell.T_base_door(recipe, *PLACEMENTS[1]), load_settings())
    done = [(s.T_base_door, cell.program_of(recipe, s)) for s in shares if s.operations]
    ways = [(T, cell.execute(program, cell.springs)) for T, program in done]
    (T_base_door, first), *others = ways
    part = inspect(recipe, T_base_door, first, others=others)
    assert len(part.features) == len(recipe.features) > 0
    for result in part.features:
        assert result.milled
        assert result.max_deviation < 1.5e-4, result.feature
