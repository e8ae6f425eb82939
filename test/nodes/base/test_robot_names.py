"""The launch file and the one-process cell put the nodes of two robots under the same names."""

from __future__ import annotations

import ast

from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.nodes.base.robots import ROBOTS, robot_remappings
from support.source_tree import ROOT


def constant(name: str) -> object:
    """A literal of the launch file, read without ROS' launch."""
    for statement in ast.parse((ROOT / "launch" / "cell.launch.py").read_text()).body:
        if isinstance(statement, ast.Assign) and getattr(statement.targets[0], "id", "") == name:
            return ast.literal_eval(statement.value)
    raise KeyError(name)


def test_the_launch_file_shares_the_same_names_with_the_cell() -> None:
    finders = ("door_localizer",)
    found = dict(robot_remappings("second", "/cell1", finders))
    assert found.pop("__ns") == "/cell1/robot2"
    assert {old for old, new in found.items() if new == f"/cell1/{old}"} == set(constant("OF_THE_CELL"))
    assert constant("ROBOTS") == {in_robot(name): name for name in ROBOTS}
