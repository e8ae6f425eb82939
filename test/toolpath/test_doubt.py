"""A door whose walls are expected too far off, and what an expected error is made of."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.toolpath.errors import ExpectedErrorError
from doormill_ros.toolpath.generate import generate_program


def thesis_hinges(**changes):
    recipe = load_recipe("thesis_190_0deg")
    features = tuple(
        replace(feature, forces=replace(feature.forces, **changes)) for feature in recipe.features
    )
    return replace(recipe, features=features)


def program(cell, recipe, robot):
    return generate_program(recipe, cell.T_base_door(recipe), cell.layout, robot, cell.springs)


def test_a_large_force_that_nobody_measured_is_refused_with_the_force_to_measure(cell):
    unknown = thesis_hinges(measured=False, std=None)
    with pytest.raises(
        ExpectedErrorError, match=r"hinge_\d, target \d+: .* measure the process force of hinge_\d"
    ) as it:
        program(cell, unknown, load_robot(cell.layout.robot))
    assert it.value.data["found"] > it.value.data["allowed"] == 0.0005


def test_a_spring_that_nobody_knows_is_the_one_to_measure(cell):
    std = 1e-3 * cell.robot.stiffness
    std[0] = 3.0 * cell.robot.stiffness[0]
    robot = replace(cell.robot, stiffness_std=std)
    with pytest.raises(ExpectedErrorError, match="measure the stiffness of joint 1"):
        program(cell, thesis_hinges(std=(0.0,) * 6), robot)


def test_more_doubt_corrects_less_and_expects_more(cell):
    robot = load_robot(cell.layout.robot)
    sizes = [program(cell, thesis_hinges(std=(s,) * 3 + (0.0,) * 3), robot) for s in (0.0, 30.0, 60.0)]
    assert np.all(np.diff([p.largest_correction for p in sizes]) < 0.0)
    assert np.all(np.diff([p.expected_error for p in sizes]) > 0.0)
