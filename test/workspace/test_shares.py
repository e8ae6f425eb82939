"""Doors planned for two robots at one place: what each can mill, and where the second one stands."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.workspace.advice import plan_doors, plan_shares, second_at


@pytest.fixture(scope="module")
def cell():
    layout = load_layout()
    return layout, load_robot(layout.robot), load_settings()


def lock_only(width):
    """A door with what lies on its lock edge alone."""
    recipe = load_recipe("standard_door")
    (case,) = [f for f in recipe.features if f.kind == "lock_case"]
    return replace(recipe, width=width, features=(case,))


def test_two_robots_mill_what_one_cannot_reach(cell):
    """Round the lock edge of the widest door the first robot does not get; the second faces it."""
    doors = [lock_only(1.350)]
    alone, together = plan_doors(doors, *cell), plan_shares(doors, *cell)
    assert (alone.planned, alone.refused) == (2, 2)
    assert (together.planned, together.refused, together.reason) == (2, 0, "")


def test_a_second_robot_far_away_refuses_and_is_named(cell):
    layout, robot, settings = cell
    far = replace(settings.second_robot, position=settings.second_robot.position + np.array([2.0, 0.0, 0.0]))
    found = plan_shares([lock_only(0.9)], layout, robot, replace(settings, second_robot=far))
    assert (found.planned, found.refused) == (2, 2)
    assert "second robot: " in found.reason


def test_the_second_robot_keeps_its_place_before_a_door_that_is_moved(cell):
    layout, _, settings = cell
    moved = replace(
        layout, rear_face_x=layout.rear_face_x - 0.2, centre_y=layout.centre_y + 0.1, bottom_z=0.3
    )
    found = second_at(settings, layout, moved)
    before, after = (
        np.linalg.inv(s.second_robot.T_base_second) @ place.T_base_door(0.9, 0.04)
        for s, place in ((settings, layout), (found, moved))
    )
    own = layout.T_base_door(0.9, 0.04), moved.T_base_door(0.9, 0.04)
    # As the first robot sees the door come nearer by 0.2 m and go aside by 0.1 m, so does the second, turned about.
    np.testing.assert_allclose(after[:2, 3] - before[:2, 3], (own[1] - own[0])[:2, 3], atol=1e-12)
    assert settings.second_robot.position[2] == found.second_robot.position[2]
