"""What goes wrong in a run, drawn from its seed."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

STATES = (
    "clearing",
    "idle",
    "requested",
    "writing",
    "verifying",
    "raising",
    "ready",
    "acknowledged",
    "milling",
)
#: Operations of the transport, in the order of a handover; faults hit one of the first so many.
OPERATIONS = 70

#: Over whatever transport is drawn.
ANY_KINDS = (
    *(f"kill -9 in {state}" for state in STATES),
    "kill -9 at an operation",
    "kill -9 in mid-write",
    "kill -9 any time",
    "kill -9 of the robot program",
    "kill -9 of both",
    "torn write, unnoticed",
    "torn write, reported",
    "full disk",
    "duplicate request",
    "early request",
    "two files at once",
    "late file",
    "file of another door",
    "door mixed up upstream",
    "clock step",
    "ready raised by somebody else",
    "operations fail at random",
    "late removal of the order file",
    "late upload and late removal",
    "restarts of the controller",
)
#: Faults of the network and of the web services.
RWS_KINDS = (
    "kill -9 at an operation, rws",
    "kill -9 in mid-write, rws",
    "kill -9 any time, rws",
    "kill -9 of both, rws",
    "dropped connections",
    "slow connection",
    "delivery after the timeout",
    "delivery very late",
    "session flood (503)",
    "sessions expire (401)",
    "event streams break",
)
KINDS = ("no fault", *ANY_KINDS, *RWS_KINDS)


@dataclass(frozen=True)
class Scenario:
    """One run.

    Attributes:
        seed: Where all chance of the run comes from.
        kind: What goes wrong.
        transport: "folder", "rws1", "rws2", or "rws2 of 8" with RobotWare 8's control stations.
        robot: "rapid" (the project's RAPID modules) or "blind" (mills whatever is there when ready is high).
        faults: How often it goes wrong before the run may end well.
        sabotage: Part of the handshake that is left out, to see the judge notice; "" for none.
    """

    seed: int
    kind: str
    transport: str = "folder"
    robot: str = "rapid"
    faults: int = 1
    sabotage: str = ""
    options: dict[str, float] = field(default_factory=dict)

    @property
    def strikes(self) -> bool:
        """Whether anything is to go wrong; a blind robot has no controller that starts anew."""
        return self.kind != "no fault" and not ("restarts" in self.kind and self.robot == "blind")


def draw(seed: int, index: int) -> Scenario:
    """The run of that index: kinds take turns, the rest is chance."""
    kind = KINDS[index % len(KINDS)]
    chance = random.Random(f"{seed}/{index}")
    transports = [*([] if kind in RWS_KINDS else ["folder"]), "rws1", "rws2", "rws2 of 8"]
    options = {
        "operation": chance.randint(1, OPERATIONS),
        "when": chance.uniform(0.0, 1.2),
        "hold": chance.uniform(0.3, 0.45) if "very" not in kind else chance.uniform(0.8, 2.5),
        "probability": chance.uniform(0.03, 0.2),
        "read_pause": chance.choice([0.0, 0.0, 0.002, 0.01]),
    }
    return Scenario(
        seed=chance.randrange(2**32),
        kind=kind,
        transport=chance.choice(transports),
        faults=chance.choice([1, 1, 2, 3]),
        options=options,
    )
