"""Executable door_sensors: a node for each sensor beside the camera; those that are none of the cell's stay at rest."""

from __future__ import annotations

import sys
from functools import partial

import cv2

from doormill_ros.localization.sensors.registry import CELL_SENSORS
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.sensing.sensor_localizer import SensorLocalizer


def main() -> int:
    """Run the nodes, each on one core: a second one has the other nodes to run."""
    cv2.setNumThreads(1)
    return run_nodes(*(partial(SensorLocalizer, name) for name in CELL_SENSORS))


if __name__ == "__main__":
    sys.exit(main())
