"""What the page shows of the robot's model and of the doors that question it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from doormill_ros.diagnosis.parts.telling.next_step import NextStep
from doormill_ros.monitor.finding import NamedFault
from doormill_ros.operator.views.short_text import short


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
    """The monitor's last word: in English, and as the data of which the page makes it in other languages.

    Attributes:
        sentence: The verdict; empty before the first.
        verdict: consistent, explained, partly_explained or unexplained; empty before the first.
        causes: What the verdict names.
        questioned: Doors that it rests on.
        next_measurement: What to measure next.
        next_steps: The same as data.
        remarks: Whatever else the doors tell.
        version, proposed: In use and proposed; 0: the model of the start, none.
        expected, expected_proposed: Error of the next door [m]; negative: not known.
        limit: Beyond which no door is milled [m]; 0: none.
        stopped: No door is milled.
        error_code, message: Why, or what else is wrong; the code is of the monitor's own trouble, 0: it has none.
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
    verdict: str = ""
    causes: tuple[NamedFault, ...] = ()
    questioned: int = 0
    next_steps: tuple[NextStep, ...] = ()
    error_code: int = 0

    def shortened(self) -> ModelView:
        """With texts as long as the page shows them."""
        return replace(
            self,
            sentence=short(self.sentence),
            next_measurement=short(self.next_measurement),
            message=short(self.message),
            remarks=tuple(map(short, self.remarks)),
        )

    def document(self) -> dict[str, Any]:
        """JSON-able content."""
        return asdict(self)
