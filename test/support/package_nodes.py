"""Every node class of the package; a new one is among them without being named anywhere."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from typing import Any

from rclpy.node import Node

import doormill_ros.nodes
from doormill_ros.localization.gige.library import Aravis
from doormill_ros.localization.sensors.registry import CELL_SENSORS
from doormill_ros.nodes.base.reporting_node import ReportingNode
from doormill_ros.nodes.gige_camera import GigeCamera
from doormill_ros.nodes.sensing.sensor_localizer import SensorLocalizer


def nodes_of_the_package() -> list[type[Node]]:
    """By name; those too that others are made from."""
    found = set()
    for module in pkgutil.walk_packages(doormill_ros.nodes.__path__, "doormill_ros.nodes."):
        for _, one in inspect.getmembers(importlib.import_module(module.name), inspect.isclass):
            if issubclass(one, Node) and one.__module__.startswith("doormill_ros."):
                found.add(one)
    return sorted(found, key=lambda one: one.__name__)


def reporting_nodes() -> list[type[ReportingNode]]:
    """Those that run: no other class of the package is made from them."""
    nodes = [node for node in nodes_of_the_package() if issubclass(node, ReportingNode)]
    return [node for node in nodes if not any(node in other.__mro__[1:] for other in nodes)]


def first_arguments(kind: type[ReportingNode]) -> dict[str, Any]:
    """What its class cannot be called without: a sensor, and a library that need not be installed."""
    arguments = {
        SensorLocalizer: {"sensor": next(iter(CELL_SENSORS))},
        GigeCamera: {"aravis": Aravis(None, OSError)},
    }
    return arguments.get(kind, {})
