"""The last runs below a folder to which recorders add: what cannot be read yet, or any more, is left aside by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.runs.ungauged_run import UngaugedRun, runs_of_bag
from doormill_ros.errors import DoormillError, one_line
from doormill_ros.recording.bag_folders import latest_in_bags
from doormill_ros.recording.bag_reader import is_broken_off


@dataclass(frozen=True)
class LeftBag:
    """A bag of which not all is asked.

    Attributes:
        bag: Its folder.
        why: What is wrong with it.
    """

    bag: Path
    why: str

    @property
    def words(self) -> str:
        """In a sentence."""
        return f"{self.bag}: {self.why}"


@dataclass(frozen=True, eq=False)
class LatestRuns:
    """What was found.

    Attributes:
        runs: In the order in which they began.
        left: Bags that were left aside, the one that was written to last first.
    """

    runs: Sequence[UngaugedRun]
    left: Sequence[LeftBag]


def latest_runs(folder: Path, count: int, since: str = "") -> LatestRuns:
    """The last runs below a folder; bags are read from the one that was written to last on until there are enough.

    Args:
        folder: Anywhere below it bags may be.
        count: How many runs are wanted.
        since: The first run that counts; empty: all do.
    """
    layout = load_layout()
    left: list[LeftBag] = []

    def ended_in(bag: Path) -> dict[str, UngaugedRun] | None:
        try:
            whole = not is_broken_off(bag)
            runs = list(runs_of_bag(bag, layout))
        except DoormillError as error:
            left.append(LeftBag(bag, one_line(error.message)))
            return None
        except Exception as error:  # whatever another recorder wrote: the other bags are asked
            left.append(LeftBag(bag, one_line(f"cannot be used: {error!r}")))
            return None
        # Of a bag that is written to, the run in hand is not all there.
        ended = {run.run_id: run for run in runs if whole or run.ended}
        if len(ended) < len(runs) or not (whole or runs):
            left.append(LeftBag(bag, _unfinished([run.run_id for run in runs if not run.ended])))
        return ended

    found = latest_in_bags(folder, ended_in, since, count)
    return LatestRuns(sorted(found.values(), key=lambda run: (run.time, run.run_id))[-count:], left)


def _unfinished(runs: Sequence[str]) -> str:
    names = ", ".join(runs)
    return f"is still being written or was cut off, {f'without the end of run {names}' if names else 'without a run'}"
