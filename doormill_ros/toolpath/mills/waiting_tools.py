"""What waits in a robot's rack: the tools that are not in its spindle, and what holds each of them, as bodies."""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.cell.places.rack import Rack, RackPlace
from doormill_ros.frames import transform
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.recipes.tool import Tool
from doormill_ros.robot.bodies import Body
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.settings import PathSettings

NO_TOOL = ""  #: what an empty spindle carries


def beside_rack(
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
    tools: Mapping[str, Tool],
    carried: str | None = None,
) -> CellLayout:
    """The cell with what waits in the robot's rack among its obstacles; arguments as of `waiting_tools`."""
    return _beside(layout, tuple(waiting_tools(layout, robot, settings, tools, carried)))


# Kept, so that what was worked out of the same cell is found again at the next door.
@functools.lru_cache(maxsize=32)
def _beside(layout: CellLayout, bodies: tuple[Body, ...]) -> CellLayout:
    return layout.beside(bodies)


def waiting_tools(
    layout: CellLayout,
    robot: Robot,
    settings: PathSettings,
    tools: Mapping[str, Tool],
    carried: str | None = None,
) -> list[Body]:
    """Holders and tools of the rack, base frame of the robot; none where it has no rack.

    Args:
        layout: Rack and tool of the robot.
        robot: Who stands before the rack.
        settings: How wide a mill may be and how far it stands out, for tools of which nothing else is told.
        tools: Those of which more is told, by name.
        carried: Tool in the spindle, empty for none; None for that of the first place, as it is between doors.
    """
    rack = layout.rack
    if rack is None:
        return []
    if carried is None:
        carried = rack.places[0].tool
    nose = float(layout.T_flange_tool[2, 3]) - settings.approach.nose
    sizes = tuple(_size(tools.get(place.tool), settings) for place in rack.places)
    return list(_standing(rack, robot, nose, sizes, carried))


def _size(tool: Tool | None, settings: PathSettings) -> tuple[float, float]:
    """Width of a tool, and how far it stands out of the spindle [m]."""
    width = 2.0 * settings.approach.mill_radius if tool is None else tool.diameter
    return width, tool.length if isinstance(tool, TabledTool) else settings.approach.nose


@functools.lru_cache(maxsize=32)
def _standing(
    rack: Rack, robot: Robot, nose: float, sizes: tuple[tuple[float, float], ...], carried: str
) -> tuple[Body, ...]:
    """As `waiting_tools`; `nose` is where the tools begin, flange frame, and `sizes` are theirs by place [m]."""
    bodies = []
    for place, (width, length) in zip(rack.places, sizes, strict=True):
        T_base_seat = _seat(rack, place, robot)
        bodies.append(rack.held_in(place).mapped(T_base_seat))
        if place.tool != carried:
            middle = np.array([0.0, 0.0, nose + 0.5 * length])
            size = np.array([width, width, length])
            standing = Body(tool_name(place), "box", size=size, position=middle, rotation=np.zeros(3))
            bodies.append(standing.mapped(T_base_seat))
    return tuple(bodies)


def tool_name(place: RackPlace) -> str:
    """What a refusal calls the tool of a place."""
    return f"tool {place.tool}"


def _seat(rack: Rack, place: RackPlace, robot: Robot) -> FloatArray:
    """The flange where the tool of a place is seated, base frame, shape (4, 4)."""
    return Kinematics(robot).forward(place.front) @ transform(translation=np.array([0.0, 0.0, rack.depth]))
