"""What goes wrong with a door, drawn from the afternoon's seed."""

from __future__ import annotations

import random
from dataclasses import dataclass

from support.deaths.strikes import STAGES

KINDS = (
    "none",
    "kill -9",
    "stop and continue",
    "network of the controller cut",
    "camera pulled",
    "folder of target files gone",
    "disk of the recorder full",
    "clock set",
    "clamp opened",
    "other goal meanwhile",
)
STRUCK = (
    "recipe_database",
    "door_localizer",
    "path_generator",
    "abb_bridge",
    "bag_recorder",
    "cell_simulator",
)
LONGEST_DELAY, SHORTEST, LONGEST = 1.0, 0.2, 4.0  # s
HOUR = 3600.0  # s


@dataclass(frozen=True)
class Fault:
    """What happens, to whom, so long after which stage and for how long [s]; `step` of the clock [s]."""

    kind: str
    node: str
    stage: str
    delay: float
    lasts: float
    step: float


def draw(seed: int, index: int) -> Fault:
    """The fault of one door; no kind comes again before all came."""
    rng = random.Random(f"{seed} {index}")
    order = list(KINDS)
    random.Random(f"{seed} round {index // len(KINDS)}").shuffle(order)
    return Fault(
        order[index % len(KINDS)],
        rng.choice(STRUCK),
        rng.choice(STAGES),
        rng.uniform(0.0, LONGEST_DELAY),
        rng.uniform(SHORTEST, LONGEST),
        rng.choice((-HOUR, HOUR)),
    )
