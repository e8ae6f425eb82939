"""Which sensors find the doors of a cell, and which nodes they are."""

from __future__ import annotations

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.cell.graph.node_names import DOOR_LOCALIZER
from doormill_ros.cell.places.layout import CAMERA, CellLayout


def chosen_sensors(layout: CellLayout, named: str = "") -> tuple[str, ...]:
    """The sensors of a cell, the one first from whose pose is milled.

    Args:
        layout: Of config/cell.yaml.
        named: Others, with commas between them, as the nodes' parameter `sensors` holds them; empty for the layout's.

    Raises:
        BadParameterError: None, or one of them twice.
    """
    names = tuple(part.strip() for part in named.split(",")) if named.strip() else layout.sensors
    if not names or "" in names or len(set(names)) < len(names):
        raise BadParameterError(
            f"the cell's sensors are {list(names)}, allowed are one or more names, each once; correct `sensors` in "
            "config/cell.yaml or the parameter of that name"
        )
    return names


def node_of(sensor: str) -> str:
    """Name of the node that finds the door with a sensor."""
    return DOOR_LOCALIZER if sensor == CAMERA else sensor
