"""What the page shows of the robot's model and of the doors that question it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class TrendDoor:
    """An inspected door.

    Attributes:
        door_id: What was milled.
        run_id: By which run.
        model_version: It was corrected with.
        largest: How far its worst point is off [m].
    """

    door_id: str
    run_id: str
    model_version: int
    largest: float


@dataclass(frozen=True)
class ModelView:
    """The monitor's last word.

    Attributes:
        sentence: The verdict; empty before the first.
        next_measurement: What to measure next.
        remarks: Whatever else the doors tell.
        version, proposed: In use and proposed; 0: the model of the start, none.
        expected, expected_proposed: Error of the next door [m]; negative: not known.
        limit: Beyond which no door is milled [m]; 0: none.
        stopped: No door is milled.
        message: Why, or what else is wrong.
        asking: A newer verdict is being worked out.
        waiting: Inspections whose run no bag holds yet.
        doors: The last 100 inspected ones, oldest first.
    """

    sentence: str = ""
    next_measurement: str = ""
    remarks: tuple[str, ...] = ()
    version: int = 0
    proposed: int = 0
    expected: float = -1.0
    expected_proposed: float = -1.0
    limit: float = 0.0
    stopped: bool = False
    message: str = ""
    asking: bool = False
    waiting: int = 0
    doors: tuple[TrendDoor, ...] = ()

    def document(self) -> dict[str, Any]:
        """JSON-able content."""
        return asdict(self)
