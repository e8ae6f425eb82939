"""The shift of doors that the simulated nodes count, in the world that their parameters name."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.world.door_truth import TAKT, DoorTruth
from doormill_ros.simulation.world.world_file import ShiftWorld, load_world

WORLD_PARAMETERS = (
    NodeParameter(
        "world", "", "file that says how the simulated cell really is; empty: as the project assumes"
    ),
    NodeParameter("door_number", 0, "of the first door in its shift, counted from 0", 0, 2**31 - 1),
)


class SimulatedShift:
    """Counts the doors of a simulated node.

    Attributes:
        number: Of the door in hand.
        door: What is true of it, once one was begun.
    """

    def __init__(self, world: str, first: int, began: float = 0.0) -> None:
        """Begin before door `first`.

        Args:
            world: File of the world; "" for the one that the project assumes.
            first: Number of the next door.
            began: When door 0 came [s since the epoch]; 0 for now.

        Raises:
            WorldFileError: The file cannot be used.
        """
        self._world_given = bool(world)
        self._world = load_world(Path(world)) if world else ShiftWorld()
        layout = load_layout()
        # Table of links and tool are all that the truth takes from the descriptions.
        self._dh, self._T_flange_tool = load_robot(layout.robot).dh, layout.T_flange_tool
        self._next = self.number = first
        self._began = datetime.fromtimestamp(began, UTC) if began else datetime.now(UTC)

    def ended(self) -> datetime:
        """When the door in hand is done, by the clock of the shift: a simulated run takes less than its door's time."""
        return self._began + timedelta(seconds=(self.number + 1) * TAKT)

    def begin(self) -> DoorTruth:
        """The next door."""
        self.number, self._next = self._next, self._next + 1
        self.door = DoorTruth(self._world, self.number, self._dh, self._T_flange_tool)
        return self.door

    def T_base_door(self, pictured: FloatArray) -> FloatArray:
        """Where the door in hand stands while it is milled, by where it stood in its picture, both (4, 4)."""
        return self.door.T_base_door(pictured) if self._world_given else pictured

    def executed(self, recipe: Recipe, T_base_door: FloatArray, path: ExecutedPath) -> ExecutedPath:
        """A path as this world's robot followed it into the door in hand, which stood at T_base_door, (4, 4)."""
        return self.door.executed(recipe, T_base_door, path) if self._world_given else path
