"""Configurations near a border of quadrants: ways keep the configuration of the file, paths follow the axes alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.resources import resource
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES
from doormill_ros.simulation.controller.motions.limits import load_limits
from doormill_ros.simulation.controller.rapid.errors import RapidMotionError

DOOR = "thesis_190_0deg"
#: A calibration that may move an axis so far to either side [rad].
CALIBRATION = np.radians(1.0)


@pytest.fixture
def robot(door, controller, tmp_path: Path):
    """A robot before the door, on modules of which a word may be another."""

    def robot_(before: str = "", after: str = ""):
        modules = []
        for name in OWN_MODULES:
            path = tmp_path / Path(name).name
            text = resource(name).read_text()
            if name.endswith("DoorMill.mod"):
                assert before in text
                text = text.replace(before, after)
            path.write_text(text)
            modules.append(path)
        (tmp_path / signals.TARGET_FILE).write_bytes(render_target_file(door(DOOR), "run-1"))
        return controller(modules=modules, limits=replace(load_limits(), quadrant_margin=CALIBRATION))

    return robot_


def test_the_door_has_targets_at_a_border(door, arm):
    """What the other tests need: axis 1, 4 or 6 so near to a multiple of 90 degrees that a calibration decides."""
    program = door(DOOR)
    near = 0
    for target in program.targets:
        turns = np.degrees(target.q[[0, 3, 5]])
        near += bool(np.abs(turns - 90.0 * np.round(turns / 90.0)).min() < np.degrees(CALIBRATION))
    assert near >= 2


def test_a_door_at_a_border_is_milled_on_either_side(robot):
    milling = robot()
    seen = []
    told = milling.move

    def move(order):
        planner = milling._planner
        seen.append((order.kind, planner.linear_supervision, planner.joint_configuration))
        told(order)

    milling.move = move
    milling.run()
    assert "Door is milled." in milling.pendant_lines
    assert {kind for kind, _, _ in seen} >= {"MoveAbsJ", "MoveL", "MoveC"}
    assert {(linear, joint) for _, linear, joint in seen} == {(False, True)}


def test_under_linear_supervision_the_same_door_stops_in_the_wood(robot):
    with pytest.raises(RapidMotionError, match="within its quadrant"):
        robot("ConfL\\Off;", "ConfL\\On;").run()
