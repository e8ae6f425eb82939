"""Which run is being handed over, and how the earlier ones ended."""

from __future__ import annotations

from dataclasses import replace

from doormill_ros.abb.handshake.inbox import Submission
from doormill_ros.abb.handshake.state import RunOutcome

_OUTCOMES_REMEMBERED = 1000


class RunLedger:
    """Written by the stepping thread; `outcome` may be asked from any."""

    def __init__(self) -> None:
        self._present: Submission | None = None
        self._outcomes: dict[str, RunOutcome] = {}

    def begin(self, submission: Submission) -> None:
        """This run is being handed over now."""
        self._present = submission

    def end(self, handed_over: bool, code: int, reason: str) -> RunOutcome | None:
        """Close the present run; None when there is none."""
        run, self._present = self._present, None
        if run is None:
            return None
        outcome = RunOutcome(run.run_id, run.door_id, handed_over, code, reason)
        self._outcomes[run.run_id] = outcome
        if len(self._outcomes) > _OUTCOMES_REMEMBERED:
            del self._outcomes[next(iter(self._outcomes))]
        return outcome

    def recall(self, run_id: str, milled: bool | None, reason: str) -> None:
        """A run that the robot took unseen, whatever was thought of it; how far the robot is with it."""
        known = self._outcomes.get(run_id)
        if run_id and (known is None or not known.handed_over or (milled and not known.milled)):
            self._outcomes[run_id] = RunOutcome(run_id, self.door_of(run_id), True, 0, reason, milled)

    def door_of(self, run_id: str) -> str:
        """The door of a run that ended; empty where it is unknown."""
        known = self._outcomes.get(run_id)
        return "" if known is None else known.door_id

    def end_milling(self, run_id: str, milled: bool, reason: str) -> None:
        """Say how the milling of a run that was handed over ended; without effect for another."""
        outcome = self._outcomes.get(run_id)
        if outcome is not None and outcome.handed_over:
            self._outcomes[run_id] = replace(outcome, milled=milled, reason=reason)

    def outcome(self, run_id: str) -> RunOutcome | None:
        """How a run ended, None while it goes on or when it is unknown."""
        return self._outcomes.get(run_id)
