"""What the replay of one bag comes to, small enough to travel and to stand in a line of a table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from doormill_ros.recording.replay.offline import OfflineOptions, replay_offline
from doormill_ros.recording.replay.replay import replay_bag


@dataclass(frozen=True)
class BagVerdict:
    """How a bag compares with what today's software answers.

    Attributes:
        runs: How many it holds.
        compared: Messages that were compared.
        differing: Fields that differ.
        first: The first of them; empty where none does.
    """

    runs: int
    compared: int
    differing: int
    first: str

    @property
    def equal(self) -> bool:
        """Nothing differs."""
        return self.differing == 0


def judge_bag(bag: str, options: OfflineOptions | None = None) -> BagVerdict:
    """Replay a bag offline.

    Args:
        bag: Its folder.
        options: As for `replay_offline`.

    Raises:
        BagError: It cannot be replayed, or nothing differs and the end of a run is missing.
    """
    outcome = replay_bag(Path(bag), partial(replay_offline, options=options))
    if not outcome.found:
        outcome.check_ended()
    first = str(outcome.found[0]) if outcome.found else ""
    return BagVerdict(len(outcome.answers), sum(outcome.counts.values()), len(outcome.found), first)
