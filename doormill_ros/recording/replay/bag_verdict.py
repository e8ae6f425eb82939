"""What the replay of one bag comes to, small enough to travel and to stand in a line of a table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path

from doormill_ros.pipeline.plan import load_setup
from doormill_ros.recipes.store.engine import check_file
from doormill_ros.recording.replay.offline import OfflineOptions, replay_offline
from doormill_ros.recording.replay.replay import replay_bag


@dataclass(frozen=True)
class BagVerdict:
    """How a bag compares with what today's software answers.

    Attributes:
        runs: How many it holds.
        compared: Messages that were compared.
        differing: Fields that differ.
        first: The first of them, else the first message that was not compared and why; empty without either.
    """

    runs: int
    compared: int
    differing: int
    first: str

    @property
    def equal(self) -> bool:
        """Something was compared, and nothing differs."""
        return self.compared > 0 and self.differing == 0


def judge_bag(bag: str, options: OfflineOptions | None = None) -> BagVerdict:
    """Replay a bag offline.

    Args:
        bag: Its folder.
        options: As for `replay_offline`.

    Raises:
        BagError: It cannot be replayed, or nothing differs and the end of a run is missing.
        DoormillError: The options name a database or a model that is not there, as on another machine.
    """
    if options is not None and options.database:
        check_file(options.database)
    if options is not None and options.robot_model:
        _check_model(options.robot_model)
    outcome = replay_bag(Path(bag), partial(replay_offline, options=options))
    if not outcome.found:
        outcome.check_ended()
    left_out = f"not compared: {outcome.left_out[0]}" if outcome.left_out else ""
    first = str(outcome.found[0]) if outcome.found else left_out
    return BagVerdict(len(outcome.answers), sum(outcome.counts.values()), len(outcome.found), first)


@lru_cache(maxsize=1)
def _check_model(name: str) -> None:
    load_setup(model=name)
