"""Where the nodes of two robots are: in a namespace each below the cell's, with what is the door's taken from there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from doormill_ros.cell.graph.node_names import (
    CAMERA_SIMULATOR,
    DOOR_SHARES,
    RECIPE_DATABASE,
    SENSOR_SIMULATOR,
)
from doormill_ros.cell.graph.topic_names import SHARE_RESULT
from doormill_ros.cell.graph.two_robots import FIRST, SECOND, in_robot
from doormill_ros.nodes.base import topics

ROBOTS = (FIRST, SECOND)  #: in the order in which they mill
#: Names that the nodes of a robot share with the cell. A share is no run: its result has another name.
_OF_THE_CELL = (
    topics.DOOR_RECIPE.name,
    topics.DOOR_POSE.name,
    topics.DOOR_LOCALIZATION.name,
    topics.SENSOR_LOCALIZATION.name,
    topics.DOOR_PLACEMENT.name,
    "recipes/get",
    *(f"_alive/{node}" for node in (RECIPE_DATABASE, CAMERA_SIMULATOR, SENSOR_SIMULATOR, DOOR_SHARES)),
)


def robot_remappings(name: str, cell: str = "", finders: tuple[str, ...] = ()) -> list[tuple[str, str]]:
    """How the names of a robot's nodes are remapped, `__ns` among them.

    Args:
        name: "first" or "second".
        cell: Namespace of the cell, such as "/cell1"; empty: none.
        finders: Nodes that find the door.
    """
    alive = (f"_alive/{node}" for node in finders)
    return [
        ("__ns", f"{cell}/{in_robot(name)}"),
        *((shared, f"{cell}/{shared}") for shared in (*_OF_THE_CELL, *alive)),
        (topics.RUN_RESULT.name, SHARE_RESULT),
        *((f"/{own}", own) for own in ("tf", "tf_static")),
    ]


def robot_arguments(
    name: str, parameters: Mapping[str, Any], cell: str = "", finders: tuple[str, ...] = ()
) -> list[str]:
    """ROS arguments of one node of a robot in a process with others; see `robot_remappings`.

    Args:
        name: "first" or "second".
        parameters: Of the node.
        cell: Namespace of the cell.
        finders: Nodes that find the door.
    """
    arguments = ["--ros-args"]
    for old, new in robot_remappings(name, cell, finders):
        arguments += ["-r", f"{old}:={new}"]
    for key, value in parameters.items():
        arguments += ["-p", f"{key}:={value}"]
    return arguments
