"""Executable cell_simulator: camera, other sensors and controller, each a simulated node, in one process."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.nodes.base.robots import ROBOTS, robot_arguments
from doormill_ros.nodes.process.dds_settings import make_room_for_pictures
from doormill_ros.nodes.process.help_page import parameters_page, words_apart
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.simulated.camera_simulator import CameraSimulator
from doormill_ros.nodes.simulated.controller_simulator import ControllerSimulator
from doormill_ros.nodes.simulated.sensor_simulator import SensorSimulator
from doormill_ros.nodes.simulated.shared_door_judge import SharedDoorJudge


def main() -> int:
    """Run the nodes."""
    make_room_for_pictures()
    parser = argparse.ArgumentParser(
        description=__doc__,
        epilog=parameters_page((CameraSimulator, SensorSimulator, ControllerSimulator)),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument(
        "--robots", type=int, choices=(1, 2), default=1, help="2: a controller for each of two"
    )
    parser.add_argument(
        "--controllers",
        type=Path,
        default=Path("out/controller"),
        help="of two robots: folder of robot1/HOME and robot2/HOME",
    )
    own, of_ros = words_apart(sys.argv[1:])
    options = parser.parse_args(own)
    arguments = [sys.argv[0], *of_ros]
    if options.robots == 1:
        return run_nodes(CameraSimulator, SensorSimulator, ControllerSimulator, arguments=arguments)
    controllers = [partial(_controller_of, robot, options.controllers) for robot in ROBOTS]
    return run_nodes(CameraSimulator, SensorSimulator, SharedDoorJudge, *controllers, arguments=arguments)


def _controller_of(robot: str, folder: Path) -> ControllerSimulator:
    """The controller of one of two robots, in its namespace below that of the process."""
    home = folder / in_robot(robot) / "HOME"
    home.mkdir(parents=True, exist_ok=True)
    values = {"share": robot, "home": home}
    return ControllerSimulator(cli_args=robot_arguments(robot, values, _namespace()))


def _namespace() -> str:
    """Of the process, empty for none."""
    given = [word.partition(":=")[2] for word in sys.argv if word.startswith("__ns:=")]
    return f"/{given[-1].strip('/')}".rstrip("/") if given else ""


if __name__ == "__main__":
    sys.exit(main())
