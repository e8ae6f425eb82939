"""Which nodes the launch file starts, by its arguments, as ROS' own launch works them out."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from launch.actions import DeclareLaunchArgument
from launch_ros.actions import Node

from launch import LaunchContext
from support.source_tree import ROOT

CAMERAS = {"folder_camera", "gige_camera"}


def launched(**given: str) -> tuple[set[str], str]:
    """Executables that are started, and whether the simulated camera draws pictures."""
    description = runpy.run_path(str(ROOT / "launch" / "cell.launch.py"))["generate_launch_description"]()
    context = LaunchContext()
    context.launch_configurations.update(given)
    started, draws = set(), ""
    for entity in description.entities:
        if isinstance(entity, DeclareLaunchArgument):
            entity.visit(context)
        elif isinstance(entity, Node) and (entity.condition is None or entity.condition.evaluate(context)):
            started.add(entity.node_executable)
            if entity.node_executable == "cell_simulator":
                draws = worked_out(entity, context)
    return started, draws


def told(page: str, argument: str) -> dict[str, str]:
    """The arguments of the one command with that argument on a page."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    (command,) = re.findall(rf"`ros2 launch doormill_ros cell\.launch\.py ({argument}:=[^`]*)`", text)
    return dict(word.split(":=") for word in command.split())


def worked_out(node: Node, context: LaunchContext) -> str:
    words = ["".join(part.perform(context) for part in word) for word in node.cmd]
    (found,) = [word for word in words if word.startswith("camera_simulator:pictures:=")]
    return found.partition(":=")[2].lower()


@pytest.mark.parametrize(
    ("given", "cameras", "draws"),
    [
        ({}, set(), "true"),
        ({"camera": "gige"}, {"gige_camera"}, "false"),
        ({"pictures": "brought"}, {"folder_camera"}, "false"),
    ],
)
def test_one_camera_is_started(given: dict[str, str], cameras: set[str], draws: str) -> None:
    started, drawn = launched(**given)
    assert started & CAMERAS == cameras
    assert drawn == draws
    assert "cell_simulator" in started


def test_of_a_real_cell_nothing_is_simulated() -> None:
    started, _ = launched(camera="gige", simulate="false")
    assert "cell_simulator" not in started
    assert {"gige_camera", "door_localizer"} <= started


def test_another_camera_is_refused() -> None:
    with pytest.raises(RuntimeError, match="Valid options are: \\['', 'gige'\\]"):
        launched(camera="usb")


def test_the_other_sensors_of_a_page_are_started_beside_the_camera() -> None:
    assert "door_sensors" not in launched()[0]
    started, _ = launched(**told("sensors.md", "door_sensors"))
    assert {"door_sensors", "door_localizer", "cell_simulator"} <= started


def test_rviz_is_started_with_the_project_s_view() -> None:
    assert "rviz2" not in launched()[0]
    started, _ = launched(**told("recording.md", "rviz"))
    assert {"rviz2", "door_localizer", "cell_simulator"} <= started
    description = runpy.run_path(str(ROOT / "launch" / "cell.launch.py"))["generate_launch_description"]()
    nodes = [entity for entity in description.entities if isinstance(entity, Node)]
    (rviz,) = [node for node in nodes if node.node_executable == "rviz2"]
    words = ["".join(part.perform(LaunchContext()) for part in word) for word in rviz.cmd[1:3]]
    assert words[0] == "-d"
    assert Path(words[1]).read_bytes() == (ROOT / "config" / "cell.rviz").read_bytes()
