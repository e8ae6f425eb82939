"""Tools that wait in the rack: who touches them is told, but for a spindle that changes its tool."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judge import judge
from support.flights import joint_flight, straight
from support.two_tools import two_tool_door

CELL, LAYOUT, ROBOT = load_cell(), load_layout(), load_robot("irb6600_175_255")
DOOR = two_tool_door()
T_BASE_DOOR = LAYOUT.T_base_door(DOOR.width, DOOR.thickness)
OWN, OTHER = (place.tool for place in LAYOUT.rack.places)
DEPTH = LAYOUT.rack.depth


def into(number, carried, aside=0.0, deeper=0.0):
    """The spindle goes straight into a place and out again; `aside` [m] beside its line, `deeper` [m] than its seat.

    Args:
        number: Of the place, from 0.
        carried: Tools in the spindle before it is there and after.
        aside: Along y of the flange [m].
        deeper: Along its axis [m].
    """
    front = LAYOUT.rack.places[number].front
    way = straight([0, aside, 0], [0, aside, DEPTH + deeper], [0, aside, 0], step=2e-3)
    poses = np.tile(Kinematics(ROBOT).forward(front), (len(way), 1, 1))
    poses[:, :3, 3] += way @ poses[0, :3, :3].T
    flown = joint_flight(CELL, inverse_near(ROBOT, poses, front))
    here = int(np.argmax(way[:, 2]))
    tool = [carried[0]] * here + [carried[1]] * (len(way) - here)
    return replace(flown, tool=np.array(tool))


def touched(executed, cell=CELL):
    """Pairs of body and obstacle."""
    found = judge(DOOR, T_BASE_DOOR, executed, cell).touches
    return {(touch.body, touch.obstacle) for touch in found}


@pytest.mark.parametrize("carried", [(OTHER, ""), ("", OTHER)], ids=["put", "taken"])
def test_a_tool_that_goes_into_its_place_or_out_of_it_touches_nothing(carried):
    assert touched(into(1, carried)) == set()


def test_an_empty_spindle_that_finds_its_place_may_stand_there():
    assert touched(into(1, ("", ""))) == set()


def test_another_tool_in_that_place_meets_what_stands_there():
    assert touched(into(1, (OWN, OWN))) == {("mill", f"tool {OTHER}"), ("mill", f"holder of {OTHER}")}


def test_beside_the_line_into_its_place_a_tool_meets_the_holder():
    assert touched(into(1, (OTHER, OTHER), aside=5e-3)) == {("mill", f"holder of {OTHER}")}
    assert touched(into(1, (OTHER, OTHER), aside=1e-3)) == set()


def test_a_spindle_that_goes_too_far_meets_the_holder():
    assert touched(into(1, (OTHER, OTHER), deeper=0.012)) >= {("spindle", f"holder of {OTHER}")}


def swing():
    """Axis 1 turns an arm as deep as in its place from between both places through the second one."""
    front = LAYOUT.rack.places[1].front
    poses = np.tile(Kinematics(ROBOT).forward(front), (1, 1, 1))
    poses[:, :3, 3] += (DEPTH - 0.08) * poses[0, :3, 2]
    seat = inverse_near(ROBOT, poses, front)[0]
    turned = np.linspace(seat[0] - 0.05, seat[0] + 0.05, 200)
    return joint_flight(CELL, np.column_stack([turned, np.tile(seat[1:], (200, 1))]))


@pytest.mark.parametrize(
    ("carried", "met"),
    [
        # Whose spindle nobody watched has the tool of the first place.
        (None, {("mill", f"tool {OTHER}"), ("mill", f"holder of {OTHER}")}),
        (OWN, {("mill", f"tool {OTHER}"), ("mill", f"holder of {OTHER}")}),
        (OTHER, {("mill", f"holder of {OTHER}")}),
        ("", set()),
    ],
)
def test_a_tool_is_in_the_way_of_whoever_does_not_have_it(carried, met):
    flown = swing()
    if carried is not None:
        tool = np.full(len(flown), carried or OWN)
        tool[1:] = carried  # an empty spindle had one before
        flown = replace(flown, tool=tool)
    assert touched(flown) == met


def test_a_cell_without_a_rack_has_nothing_there():
    assert touched(swing(), replace(CELL, rack=())) == set()
