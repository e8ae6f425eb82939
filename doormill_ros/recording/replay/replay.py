"""Replay every run of a bag and say what is not as it was."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from doormill_ros.cell.graph.topic_names import RUN_RESULT
from doormill_ros.recording.completeness import check_whole
from doormill_ros.recording.errors import IncompleteBagError
from doormill_ros.recording.replay.answer import RECIPE_STAGE, Answer
from doormill_ros.recording.replay.compare import Difference, differences
from doormill_ros.recording.replay.expectation import read_expectation
from doormill_ros.recording.replay.offline import OFFLINE_STAGES, replay_offline
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.recording.replay.run_reader import read_runs

Replayer = Callable[[RecordedRun], Sequence[Answer]]


@dataclass
class ReplayOutcome:
    """What came of a replay.

    Attributes:
        bag: Which bag.
        answers: What the stages answered now, by run id.
        found: Every difference, the first one first.
        unended: A sentence for each run whose end was not recorded; no stage of it was asked.
    """

    bag: Path
    answers: dict[str, list[Answer]] = field(default_factory=dict)
    found: list[Difference] = field(default_factory=list)
    unended: list[str] = field(default_factory=list)

    @property
    def counts(self) -> dict[str, int]:
        """Compared messages by topic."""
        counts: dict[str, int] = {}
        for answers in self.answers.values():
            for answer in answers:
                if not answer.not_compared:
                    counts[answer.topic] = counts.get(answer.topic, 0) + 1
        return counts

    @property
    def left_out(self) -> list[str]:
        """Topic and reason of every message that was not compared."""
        answers = [answer for of_run in self.answers.values() for answer in of_run]
        return [f"{answer.topic}: {answer.not_compared}" for answer in answers if answer.not_compared]

    def check_ended(self) -> None:
        """Refuse a bag with a run that was not compared because its end is missing.

        Raises:
            IncompleteBagError: There is one.
        """
        if self.unended:
            raise IncompleteBagError(f"bag {self.bag} is not compared: {'; '.join(self.unended)}")


def replay_bag(
    bag: Path,
    replayer: Replayer = replay_offline,
    topics: Sequence[str] = OFFLINE_STAGES,
    slack: float = 1.0,
) -> ReplayOutcome:
    """Replay a bag against its expected.yaml, or against what was recorded when it has none.

    Args:
        bag: Bag folder.
        replayer: Gives the answers of a run's stages.
        topics: Topics to compare.
        slack: Factor on tolerances, for answers that follow from replayed instead of recorded ones.

    Raises:
        UnreadableBagError: No such bag, or damaged beyond reading.
        EmptyBagError: No run is in it.
        IncompleteBagError: It holds fewer messages than its metadata.yaml lists.
        BadExpectationError: Its expected.yaml is not of its form.
    """
    outcome = ReplayOutcome(bag)
    written = read_expectation(bag) or {}
    runs = read_runs(bag)
    check_whole(bag)
    for run in runs:
        if run.result is None:
            # What was recorded of it may be any part of what there was: being like that says nothing.
            outcome.unended.append(
                f"run {run.run_id} has no {RUN_RESULT}, its recording stopped before it ended; record a whole run"
            )
            continue
        recorded = run.answers()
        # The recipe is an input of the other stages: expected.yaml has nothing to say about it.
        wanted = [a for a in recorded if a.topic == RECIPE_STAGE] + [
            a for a in written.get(run.run_id, recorded) if a.topic != RECIPE_STAGE
        ]
        expected = [a for a in wanted if a.stage in topics]
        found = [a for a in replayer(run) if a.stage in topics]
        outcome.answers[run.run_id] = found
        outcome.found.extend(differences(run.run_id, expected, found, slack))
    return outcome
