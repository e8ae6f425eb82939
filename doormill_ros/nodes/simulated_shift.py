"""The shift of doors that the simulated nodes count, in the world that their parameters name."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

from doormill_ros.cell.layout import load_layout
from doormill_ros.nodes.reporting_node import NodeParameter
from doormill_ros.robot.description import load_robot
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
        world_given: Whether a world file was named.
        number: Of the door in hand.
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
        self.world_given = bool(world)
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
        return DoorTruth(self._world, self.number, self._dh, self._T_flange_tool)
