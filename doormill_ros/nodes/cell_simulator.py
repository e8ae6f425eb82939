"""Executable cell_simulator: the nodes /camera_simulator and /controller_simulator in one process."""

from __future__ import annotations

import sys

from doormill_ros.nodes.camera_simulator import CameraSimulator
from doormill_ros.nodes.controller_simulator import ControllerSimulator
from doormill_ros.nodes.large_messages import make_room_for_pictures
from doormill_ros.nodes.run import run_nodes


def main() -> int:
    """Run both nodes."""
    make_room_for_pictures()
    return run_nodes(CameraSimulator, ControllerSimulator)


if __name__ == "__main__":
    sys.exit(main())
