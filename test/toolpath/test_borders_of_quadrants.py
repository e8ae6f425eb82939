"""No motion of a program may end in a configuration that a calibrated arm does not have."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.recipes.door import HingeSide
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.simulation.controller.motions.limits import load_limits
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.errors import PathError
from support import doors
from support.file_run import read_file

#: What the simulated controller takes a calibration for: no public source says how far it moves the zero of an axis.
MARGIN = load_limits().quadrant_margin
TILT = math.radians(2.0)
WIDTHS = [290.0, 731.3, 1350.0, *np.random.default_rng(7).uniform(290.0, 1350.0, 9).round(1).tolist()]


def placed_doors(cell):
    """Doors with one feature or two on different sides, by kind and width, hung and tilted either way."""
    random = np.random.default_rng(8)
    for kind, width in itertools.product(FEATURES, WIDTHS):
        recipe = doors.door_with(kind, 2100, width, 40)
        hinge = doors.door_with("hinge_leaf", 2100, width, 40).features[0]
        if kind != "hinge_leaf":
            recipe = replace(recipe, features=(replace(hinge, height=1.5), *recipe.features))
        recipe = replace(recipe, hinge_side=list(HingeSide)[random.integers(2)])
        offset = (
            *random.uniform(-0.01, 0.01, 2),
            random.choice([-TILT, 0.0, TILT, random.uniform(-TILT, TILT)]),
        )
        yield recipe, cell.T_base_door(recipe, *offset)


@pytest.fixture(scope="module")
def programs(cell):
    """Programs of the doors that the robot serves, with what their target files say."""
    made = []
    for recipe, T_base_door in placed_doors(cell):
        try:
            program = cell.program(recipe, T_base_door)
        except PathError:
            continue
        made.append((recipe, program, read_file(render_target_file(program, "run").decode("ascii"))))
    assert len(made) > len(WIDTHS) * len(FEATURES) / 2
    assert len({(recipe.hinge_side, recipe.features[-1].kind) for recipe, _, _ in made}) > len(FEATURES)
    return made


def test_no_motion_is_a_move_j(programs):
    """Its target has a configuration, which near a border of quadrants is another one on a calibrated arm."""
    assert {motion.kind for _, _, written in programs for motion in written.motions} == {"A", "L", "C"}


def test_what_begins_at_a_point_of_joint_space_ends_in_the_air(programs):
    """A MoveAbsJ knows of no calibration: what it is off is gone before the tool is in the wood."""
    followed = 0
    for _, _, written in programs:
        for before, after in itertools.pairwise(written.motions):
            if before.kind == "A" and after.kind != "A":
                followed += 1
                assert after.kind == "L"
                assert not after.cutting
    assert followed >= len(programs)


@pytest.mark.parametrize("name", ["standard_door", "thesis_190_2deg"])
def test_a_calibration_that_points_do_not_know_of_leaves_the_walls_as_they_are(cell, name):
    """Every point half a degree off in each joint, some 20 mm at the tool: the paths cut the same wood."""
    recipe = cell.recipe(name)
    T_base_door = cell.placed(recipe)
    program = cell.program(recipe, T_base_door)
    signs = np.random.default_rng(9).choice([-1.0, 1.0], (len(program.points), 6))
    points = tuple(np.array(program.points) + MARGIN * signs)
    exact, off = (
        inspect(recipe, T_base_door, cell.execute(p, cell.springs))
        for p in (program, replace(program, points=points))
    )
    assert len(exact.features) == len(recipe.features)
    for one, other in zip(exact.features, off.features, strict=True):
        assert other.max_deviation == pytest.approx(one.max_deviation, abs=1e-7)
        assert other.uncleared == pytest.approx(one.uncleared, abs=1e-9)
