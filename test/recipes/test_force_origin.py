"""What a recipe says of its forces: axes, spread, and what contradicts itself."""

import copy

import numpy as np
import pytest

from doormill_ros.recipes import errors as e
from doormill_ros.recipes.documents import load_recipe, shipped_recipes
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.program import Program
from doormill_ros.recipes.recipe import Recipe

ROW = [-209.0, 29.0, 12.0, 0.0, 0.0, 0.0]


def thesis_door(**forces):
    document = copy.deepcopy(load_recipe("thesis_190_0deg").to_document())
    for hinge in document["features"]:
        hinge["wrench_n_nm"] = {"default": ROW}
        hinge["wrench_point_mm"] = 0
        hinge.pop("forces")
        if forces:
            hinge["forces"] = forces
    return document


def upwards_and_across(feature: Feature):
    """Force on the tool along the door's height, and across the door away from its hinge edge."""
    door = load_recipe("thesis_190_0deg").size
    R_door_tool = feature.T_door_feature(door)[:3, :3] @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    force = R_door_tool @ feature.wrench("left_line")[:3]
    return force[2], force[1]


def test_feature_axes_lay_the_force_across_and_tool_axes_along_the_height():
    across = Recipe.from_document(thesis_door(axes="feature")).features[0]
    assert upwards_and_across(across) == pytest.approx((29.0, -209.0))
    assert upwards_and_across(Recipe.from_document(thesis_door()).features[0]) == pytest.approx((209.0, 29.0))


def test_a_recipe_of_before_reads_and_writes_as_it_was():
    document = thesis_door()
    recipe = Recipe.from_document(document)
    assert recipe.to_document()["features"] == document["features"]
    origin = recipe.features[0].force_origin
    assert not origin.measured
    # Off by its own size.
    assert np.linalg.norm(recipe.features[0].wrench_std("left_line")[:3]) == pytest.approx(
        np.linalg.norm(ROW[:3])
    )


def test_standard_deviations_turn_with_the_axes():
    std = [96, 12, 19, 1, 5, 2]
    door = Recipe.from_document(thesis_door(axes="feature", measured=True, std_n_nm=std, source="me"))
    assert door.features[0].wrench_std("left_line") == pytest.approx([12, 96, 19, 5, 1, 2])


@pytest.mark.parametrize(
    ("forces", "leaf", "field"),
    [
        ({"measured": True, "source": "me"}, e.MissingField, "features.0.forces.std_n_nm"),
        ({"measured": True, "std_n_nm": [1] * 6}, e.MissingField, "features.0.forces.source"),
        ({"model": "engagement", "measured": True}, e.ConflictingFields, "features.0.forces.measured"),
        ({"model": "engagement"}, e.ConflictingFields, "features.0.wrench_n_nm"),
        ({"std_n_nm": [1] * 5}, e.WrongType, "features.0.forces.std_n_nm"),
        ({"std_n_nm": [1, 1, -1, 1, 1, 1]}, e.OutOfRange, "features.0.forces.std_n_nm.2"),
        ({"axes": "base"}, e.NotAChoice, "features.0.forces.axes"),
        ({"colour": 1}, e.UnknownField, "features.0.forces.colour"),
    ],
)
def test_what_contradicts_itself_is_refused(forces, leaf, field):
    with pytest.raises(leaf) as caught:
        Recipe.from_document(thesis_door(**forces))
    assert caught.value.field == field


def test_shipped_forces_are_measured_for_the_thesis_doors_alone():
    shipped = [(recipe, feature) for recipe in shipped_recipes().values() for feature in recipe.features]
    assert len(shipped) > 7
    for recipe, feature in shipped:
        assert feature.force_origin.source
        assert feature.force_origin.measured is (recipe.program is Program.PATH_20)
        assert feature.computes_force is not feature.force_origin.measured
