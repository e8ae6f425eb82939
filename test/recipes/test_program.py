"""Which doors may ask for the thesis' program of 14 targets."""

import copy

import pytest

from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.errors import UnfitForProgram
from doormill_ros.recipes.program import Program, fits_path_20
from doormill_ros.recipes.recipe import Recipe

THESIS = load_recipe("thesis_1350_0deg")

OTHERS = {
    "nine points": {"points": 9},
    "turned": {"length_mm": 30, "width_mm": 36, "wrench_n_nm": {"default": [0] * 6}},
    "rear": {"side": "rear"},
    "conventional": {"direction": "conventional"},
    "finish": {"passes": {"depth_step_mm": 5, "finish_allowance_mm": 0.3}},
    "two passes": {"passes": {"depth_step_mm": 2.5}},
    "wide": {"width_mm": 38.1},
}


def document(change):
    changed = copy.deepcopy(THESIS.to_document())
    changed["features"][1] |= change
    return changed


def test_the_thesis_doors_ask_for_it():
    assert THESIS.program is Program.PATH_20
    assert fits_path_20(THESIS.features)


@pytest.mark.parametrize("change", OTHERS.values(), ids=OTHERS)
def test_a_door_that_it_cannot_mill_is_refused_and_the_general_program_takes_it(change):
    with pytest.raises(UnfitForProgram, match=r"^program: found 'path_20'.*allowed.*'general'$") as caught:
        Recipe.from_document(document(change))
    assert caught.value.code == 113
    assert caught.value.field == "program"
    general = Recipe.from_document({**document(change), "program": "general"})
    assert general.program is Program.GENERAL


@pytest.mark.parametrize("count", [1, 3])
def test_it_mills_two_hinges_no_more_and_no_less(count):
    changed = document({})
    hinge = changed["features"][0]
    changed["features"] = [{**hinge, "id": f"h{i}", "height_mm": 200 + 300 * i} for i in range(count)]
    with pytest.raises(UnfitForProgram):
        Recipe.from_document(changed)


def test_a_recipe_that_asks_for_nothing_gets_the_general_program():
    changed = document({})
    del changed["program"]
    assert Recipe.from_document(changed).program is Program.GENERAL
