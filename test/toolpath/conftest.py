from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.toolpath.generate import generate_program
from support import execute as _execute
from support.doors import exactly_known

THESIS_DOORS = ["thesis_190_0deg", "thesis_190_2deg", "thesis_1350_0deg", "thesis_1350_2deg"]


class Cell:
    """Layout, robot, its springs, and what a test does with them."""

    def __init__(self):
        self.layout = load_layout()
        # Springs, and the forces of `recipe`, are taken as exact: tests of what a correction is worth are elsewhere.
        robot = load_robot(self.layout.robot)
        self.robot = replace(robot, stiffness_std=1e-9 * robot.stiffness)
        self.kinematics = Kinematics(self.robot)
        self.springs = JointSpringModel(self.robot)

    def recipe(self, name):
        recipe = load_recipe(name)
        return replace(recipe, features=tuple(map(exactly_known, recipe.features)))

    def T_base_door(self, recipe, y=0.0, z=0.0, rotation=0.0):
        return self.layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(y, z, rotation))

    def placed(self, recipe):
        p = recipe.placement
        return self.T_base_door(recipe) if p is None else self.T_base_door(recipe, p.y, p.z, p.rotation)

    def program(self, recipe, T_base_door, model=None, layout=None, **options):
        return generate_program(
            recipe, T_base_door, layout or self.layout, self.robot, model or self.springs, **options
        )

    def program_of(self, recipe, share):
        """One robot's share in a cell of two, which has nothing behind the door but the second robot."""
        bare = self.layout.with_rear_free()
        return self.program(recipe, share.T_base_door, layout=bare, operations=share.operations)

    def execute(self, program, model=None, corrected=True, **options):
        return _execute.execute(
            program, self.robot, self.kinematics, self.layout.T_flange_tool, model, corrected, **options
        )


class Play:
    """Joint springs with play: a joint moved along its load falls through a gap before the spring holds."""

    def __init__(self, springs, gap):
        self.springs, self.gap = springs, np.asarray(gap, dtype=float)

    def deflection(self, q, wrench, load_point, direction=None):
        J = self.springs.kinematics.jacobian(q, load_point)
        torque = np.einsum("nij,ni->nj", J, wrench)
        fallen = np.sign(torque) * self.gap * ((np.sign(torque) * direction > 0) & (np.abs(torque) > 1e-6))
        return self.springs.deflection(q, wrench, load_point) + np.einsum("nij,nj->ni", J, fallen)


@pytest.fixture(scope="session")
def cell():
    return Cell()


@pytest.fixture(scope="session")
def play(cell):
    return lambda gap: Play(cell.springs, gap)
