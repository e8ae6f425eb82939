"""Every door that ships and is not the thesis' own: milled as its recipe says, by one robot and by two."""

import math
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.recipes.program import Program
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split
from support.doors import exactly_known

SHIPPED = shipped_recipes()
OTHERS = [name for name, recipe in SHIPPED.items() if recipe.program is Program.GENERAL]
BEND = load_settings().correction.bend
WITHIN = 5e-5  #: what a wall may be off where springs and forces are known exactly [m]
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
        assert result.max_deviation < expected(program, result.feature) + BEND, result.feature
        assert result.uncleared < 1e-9


def known(name):
    """The recipe under forces that are known exactly."""
    return replace(SHIPPED[name], features=tuple(map(exactly_known, SHIPPED[name].features)))


@pytest.mark.parametrize("place", PLACEMENTS)
@pytest.mark.parametrize("name", OTHERS)
def test_it_is_milled_within_five_hundredths_of_forces_that_are_known(cell, name, place):
    recipe = known(name)
    T_base_door = cell.T_base_door(recipe, *place)
    program = cell.program(recipe, T_base_door)
    part = inspect(recipe, T_base_door, cell.execute(program, cell.springs))
    assert [result.feature for result in part.features] == [feature.id for feature in recipe.features]
    for result in part.features:
        assert result.milled
        assert result.max_deviation < WITHIN, result.feature
        assert np.abs(result.floor).max() < WITHIN
    plain = inspect(recipe, T_base_door, cell.execute(program, cell.springs, corrected=False))
    assert min(result.max_deviation for result in plain.features) > WITHIN


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
    recipe = known(name)
    shares = split(recipe, cell.T_base_door(recipe, *PLACEMENTS[1]), load_settings())
    done = [(s.T_base_door, cell.program_of(recipe, s)) for s in shares if s.operations]
    ways = [(T, cell.execute(program, cell.springs)) for T, program in done]
    (T_base_door, first), *others = ways
    part = inspect(recipe, T_base_door, first, others=others)
    assert len(part.features) == len(recipe.features) > 0
    for result in part.features:
        assert result.milled
        assert result.max_deviation < WITHIN, result.feature
        assert np.abs(result.floor).max() < WITHIN
