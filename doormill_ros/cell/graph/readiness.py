"""Whether the cell can take a door, from what its nodes say of themselves every second."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from doormill_ros.cell.graph.door_sensors import node_of
from doormill_ros.cell.graph.node_names import (
    ABB_BRIDGE,
    BAG_RECORDER,
    DOOR_LOCALIZER,
    MODEL_MONITOR,
    OPERATOR_PAGE,
    PATH_GENERATOR,
    RECIPE_DATABASE,
)

NEEDED = (RECIPE_DATABASE, DOOR_LOCALIZER, PATH_GENERATOR, ABB_BRIDGE, BAG_RECORDER)
#: Started with them; milling goes on without.
BESIDE = (MODEL_MONITOR, OPERATOR_PAGE)
#: Of two robots each has these in its namespace.
OF_A_ROBOT = (PATH_GENERATOR, ABB_BRIDGE)
#: What the bridge says of the controller; not every transport can tell.
CONTROLLER = f"{ABB_BRIDGE}/controller"
#: A node that has not been heard of for so long counts as gone [s].
SILENCE = 3.0
WELL, WARNED, FAILED = 0, 1, 2  #: levels of diagnostics; what is above counts as FAILED
#: What a managed node says of itself in the states in which it does nothing.
IDLE = ("inactive", "unconfigured")


def needed_nodes(sensors: Sequence[str]) -> tuple[str, ...]:
    """Nodes without which a cell with these sensors mills no door."""
    return tuple(name for name in NEEDED if name != DOOR_LOCALIZER) + tuple(map(node_of, sensors))


@dataclass(frozen=True)
class _Heard:
    level: int
    message: str
    at: float


class Readiness:
    """What was heard of the nodes, and what follows from it.

    Args:
        needed: Nodes without which no door is milled, relative to the cell's namespace.
        clock: Monotonic [s].
    """

    def __init__(self, needed: Sequence[str] = NEEDED, clock: Callable[[], float] = time.monotonic) -> None:
        self._needed = tuple(needed)
        self._clock = clock
        self._begun = clock()
        self._heard: dict[str, _Heard] = {}

    def hear(self, name: str, level: int, message: str) -> None:
        """A node said something of itself; the name is relative to the cell's namespace."""
        self._heard[name] = _Heard(level, message, self._clock())

    def hindrances(self, camera: bool, readings: bool = True) -> list[str]:
        """Why no door can be milled now, a sentence each; empty when the cell is ready.

        A door that was refused hinders nothing: a warning counts only where the controller takes no files.

        Args:
            camera: Somebody offers pictures, or the cell has no camera.
            readings: Somebody offers readings of the cell's other sensors, if it has some.
        """
        now = self._clock()
        found = {name: heard for name, heard in self._heard.items() if now - heard.at < SILENCE}
        said = []
        for name in self._needed:
            if name not in found:
                listened = now - self._begun
                short = f"in {listened:.1f} s of listening; wait longer, or"
                said.append(
                    f"{name}: not heard of {f'for {SILENCE:g} s;' if listened >= SILENCE else short} start it"
                )
            elif found[name].message in IDLE:
                said.append(
                    f"{name}: {found[name].message}; activate it (ros2 lifecycle set), or see its log"
                )
        for name, heard in sorted(found.items()):
            limit = WARNED if name.endswith(CONTROLLER) else FAILED
            if heard.level >= limit and heard.message not in IDLE:
                said.append(f"{_called(name)}: {heard.message}")
        if not camera:
            said.append("camera: nobody offers pictures; start its driver")
        if not readings:
            said.append("sensors: nobody offers readings; start their drivers")
        return said


def _called(name: str) -> str:
    """What a sentence calls a node, or a controller: that of one of two robots by its namespace."""
    if not name.endswith(CONTROLLER):
        return name
    robot = name.removesuffix(CONTROLLER).rstrip("/")
    return f"controller of {robot}" if robot else "controller"
