"""Who is struck, how and when: two strikes a round, dealt so that nothing is left out."""

from __future__ import annotations

import random
from dataclasses import dataclass
from itertools import combinations_with_replacement

NODES = (
    "recipe_database",
    "door_localizer",
    "path_generator",
    "abb_bridge",
    "cell_simulator",
    "bag_recorder",
    "model_monitor",
    "operator_page",
)
STAGES = ("recipe", "picture", "pose", "targets", "ready", "milling")
PAIRS = tuple(combinations_with_replacement(STAGES, 2))
LONGEST_DELAY, SHORTEST_STOP, LONGEST_STOP = 1.0, 0.2, 4.0  # s


@dataclass(frozen=True)
class Strike:
    """What happens to whom, so long after which stage [s]."""

    node: str
    kill: bool
    stage: str
    delay: float
    stopped: float

    @property
    def kind(self) -> tuple[str, bool, str]:
        """Node, whether it is killed, and stage."""
        return self.node, self.kill, self.stage


Round = tuple[Strike, ...]


def deal(seed: int, rounds: int) -> list[Round]:
    """Rounds of two strikes: no pair of stages comes again before all came, nor a node and kind at one stage."""
    rng = random.Random(seed)
    decks: dict[str, list[tuple[str, bool]]] = {stage: [] for stage in STAGES}
    pairs: list[tuple[str, str]] = []

    def strike(stage: str) -> Strike:
        if not decks[stage]:
            decks[stage] = [(node, kill) for node in NODES for kill in (True, False)]
            rng.shuffle(decks[stage])
        node, kill = decks[stage].pop()
        delay, stopped = rng.uniform(0.0, LONGEST_DELAY), rng.uniform(SHORTEST_STOP, LONGEST_STOP)
        return Strike(node, kill, stage, delay, stopped)

    dealt = []
    for _ in range(rounds):
        if not pairs:
            pairs = list(PAIRS)
            rng.shuffle(pairs)
        first, second = pairs.pop()
        dealt.append((strike(first), strike(second)))
    return dealt
