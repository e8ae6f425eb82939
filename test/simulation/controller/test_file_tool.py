"""A file is milled with the tool that it was made for, and with no other."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import render_target_file, without_tool

MILLED = "Door is milled."


@pytest.fixture
def made(door, controller):
    """A robot with the thesis door's file."""

    def made_():
        robot = controller()
        (robot.home / signals.TARGET_FILE).write_bytes(render_target_file(door("thesis_190_0deg"), "run-1"))
        return robot

    return made_


def tool(x: float = 0.0, z: float = 250.0, turn: float = 0.0, sign: float = 1.0, scale: float = 1.0) -> str:
    """toolMill with its tip there [mm], turned about y [deg], by a quaternion that may have been typed in."""
    sign *= scale
    half = np.radians(turn) / 2.0
    rot = f"[{sign * np.cos(half):.7f},0,{sign * np.sin(half):.7f},0]"
    return f"[TRUE,[[{x},0,{z}],{rot}],[20.12,[0,0,120],[1,0,0,0],0,0,0]]"


@pytest.mark.parametrize("change", [{"z": 251.1}, {"z": 248.9}, {"x": 1.1}, {"turn": 0.7}, {"z": 130.0}])
def test_a_file_for_another_tool_is_refused(made, change):
    robot = made()
    robot.program.write("toolMill", tool(**change))
    robot.run()
    assert robot.moves == []
    assert (
        (robot.home / signals.REFUSED_FILE).read_text().startswith("1\nThe target file has another tool.\n")
    )


@pytest.mark.parametrize(
    "change", [{"z": 250.9}, {"z": 249.1}, {"x": 0.9}, {"turn": 0.3}, {"sign": -1.0}, {"scale": 1.0003}]
)
def test_a_tool_that_was_measured_is_the_files_within_a_millimetre(made, change):
    robot = made()
    robot.program.write("toolMill", tool(**change))
    robot.run()
    assert robot.pendant_lines[-1] == MILLED


def test_a_file_that_does_not_say_its_tool_is_refused(made, door):
    robot = made()
    whole = render_target_file(door("thesis_190_0deg"), "run-1")
    (robot.home / signals.TARGET_FILE).write_bytes(without_tool(whole))
    robot.run()
    assert robot.moves == []
    assert (
        (robot.home / signals.REFUSED_FILE).read_text().startswith("1\nThe target file has another tool.\n")
    )
