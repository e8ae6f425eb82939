"""Executable cell_simulator: camera, other sensors and controller, each a simulated node, in one process."""

from __future__ import annotations

import os
import sys

from doormill_ros.nodes.camera_simulator import CameraSimulator
from doormill_ros.nodes.controller_simulator import ControllerSimulator
from doormill_ros.nodes.run import run_nodes
from doormill_ros.nodes.sensor_simulator import SensorSimulator
from doormill_ros.resources import resource

#: What Fast DDS reads its settings from, in this release and in older ones.
_SETTINGS = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")


def make_room_for_pictures() -> None:
    """Let this process send pictures through shared memory in one go; to be called before rclpy.init.

    Settings of the user's own are left alone; other DDS implementations do not look at them.
    """
    if not any(name in os.environ for name in _SETTINGS):
        os.environ[_SETTINGS[0]] = str(resource("config/fastdds.xml"))


def main() -> int:
    """Run the nodes."""
    make_room_for_pictures()
    return run_nodes(CameraSimulator, SensorSimulator, ControllerSimulator)


if __name__ == "__main__":
    sys.exit(main())
