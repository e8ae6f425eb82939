"""What a watch over inspected doors goes by, and what it knows at one moment."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.monitor.finding import UNKNOWN, DoorFinding
from doormill_ros.monitor.kept_doors import KeptDoor


@dataclass(frozen=True)
class WatchSettings:
    """What a watch goes by; asked anew each time.

    Attributes:
        doors: How many of the last ones are questioned.
        since: Run before which doors and bags are left aside; empty: none are.
        limit: Expected error beyond which no door is milled [m]; 0: none.
        patience: Seconds that a diagnosis may take.
        model: Of version 0: robot or model.yaml; "" for the robot's joint springs.
        runs: How many of the last ones are asked by bags alone; 0: never.
    """

    doors: int
    since: str
    limit: float
    patience: float
    model: str
    runs: int = 0


@dataclass(frozen=True)
class WatchState:
    """What is known at one moment.

    Attributes:
        finding: What the doors say; None before the first answer.
        version: In use.
        proposed: Version of a better model; 0: none.
        expected, expected_proposed: Error of the next door [m]; UNKNOWN where nobody can tell.
        limit: Beyond which no door is milled [m].
        stopped: Why no door is milled; empty when they are.
        waiting: Inspections that wait for a bag.
        asking: A newer verdict is on its way.
        error_code, message: What is wrong; 0 and empty when nothing is.
        doors: The last inspected ones.
    """

    finding: DoorFinding | None = None
    version: int = 0
    proposed: int = 0
    expected: float = UNKNOWN
    expected_proposed: float = UNKNOWN
    limit: float = 0.0
    stopped: str = ""
    waiting: int = 0
    asking: bool = False
    error_code: int = 0
    message: str = ""
    doors: tuple[KeptDoor, ...] = ()
