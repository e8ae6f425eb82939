"""shift.json: how the doors of one shift ended (schema doormill/shift/1)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from doormill_ros.cell.output.schemas import SHIFT
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.files import write_atomically
from doormill_ros.units import m_to_mm


@dataclass(frozen=True)
class ShiftDoor:
    """One door of a shift.

    Attributes:
        number: The first one is 0.
        folder: Of its run, below the shift's.
        door_id: What was milled.
        run_id: Name of the run.
        success: Whether it is milled and nothing is wrong with it.
        largest_deviation: Of its contours from the recipe on the true door [m]; None where none was milled.
        message: What the run ended with.
        model_version: Of the robot model in the store of models; 0 for that of the start.
    """

    number: int
    folder: str
    door_id: str
    run_id: str
    success: bool
    largest_deviation: float | None
    message: str
    model_version: int = 0


@dataclass(frozen=True)
class ShiftSummary:
    """Content of shift.json.

    Attributes:
        world: The world file, empty where the cell was as assumed.
        doors: In the order in which they were milled.
    """

    world: str = ""
    doors: list[ShiftDoor] = field(default_factory=list)

    @property
    def success(self) -> bool:
        """Whether all doors are milled and nothing is wrong with them."""
        return all(door.success for door in self.doors)

    def add(self, number: int, folder: str, run: RunSummary) -> None:
        """One more door."""
        # A run that ended early has a deviation of exactly 0.
        deviation = run.feature_error.corrected_max or None
        self.doors.append(
            ShiftDoor(
                number,
                folder,
                run.door_id,
                run.run_id,
                run.success,
                deviation,
                run.message,
                run.model_version,
            )
        )

    def write(self, path: Path) -> None:
        """Write the file at once, so that no reader sees half of it."""
        write_atomically(path, json.dumps({"schema": SHIFT, **asdict(self)}, indent=2) + "\n")

    def table(self) -> str:
        """The doors as lines of text."""
        rows = [("door", "recipe", "run", "success", "largest deviation")]
        for door in self.doors:
            deviation = door.largest_deviation
            size = "-" if deviation is None else f"{m_to_mm(deviation):.3f} mm"
            rows.append((str(door.number), door.door_id, door.run_id, "yes" if door.success else "no", size))
        return "\n".join(_lines(rows))


def _lines(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
