"""How near mill and spindle come to a door, against distances known beforehand."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.recipes.door import Side
from doormill_ros.toolpath.clearance import _gaps
from doormill_ros.toolpath.settings import load_settings
from support.inverse_kinematics import inverse
from support.tool_poses import T_door_tool

APPROACH = replace(load_settings().approach, nose=0.120, mill_radius=0.010, spindle_radius=0.060)


def gap_at(cell, T_base_tool, recipe, T_base_door, approach=APPROACH):
    q = inverse(cell.robot, T_base_tool @ np.linalg.inv(cell.layout.T_flange_tool))
    found = _gaps(q, recipe.size, T_base_door, cell.robot, cell.layout, approach)
    assert np.ptp(found) < 1e-9  # whatever the arm does
    return found[0]


@pytest.mark.parametrize("distance", [0.03, 0.10, 0.0, -0.02])
def test_straight_in_front_of_the_face_the_tip_is_nearest(cell, distance):
    recipe = cell.recipe("standard_door")
    T_base_door = cell.T_base_door(recipe, 0.004, 0.002, 0.02)
    T = T_base_door @ T_door_tool(recipe.feature("hinge_2"), recipe.size, 0.0, 0.0, -distance)
    assert gap_at(cell, T, recipe, T_base_door) == pytest.approx(distance - 0.010, abs=1e-9)


def test_beside_the_edge_the_spindle_is_nearest(cell):
    """The tip far past the lock edge's corner, the axis parallel to the face, 80 mm in front."""
    recipe = cell.recipe("standard_door")
    T_base_door = cell.T_base_door(recipe)
    case = recipe.feature("lock_case")
    assert case.side is Side.LOCK_EDGE
    T_door_deep = T_door_tool(case, recipe.size, 0.0, 0.0, 0.2)
    T_door_deep[0, 3] = -0.080
    found = gap_at(cell, T_base_door @ T_door_deep, recipe, T_base_door)
    # 120 mm of the mill and 80 mm of the spindle are beside the face, the rest is past the edge.
    assert found == pytest.approx(0.080 - 0.060, abs=1e-9)
    shorter = replace(APPROACH, nose=0.210)
    found = gap_at(cell, T_base_door @ T_door_deep, recipe, T_base_door, shorter)
    # Now the spindle begins 10 mm past the edge.
    assert found == pytest.approx(np.hypot(0.080, 0.010) - 0.060, abs=1e-9)
