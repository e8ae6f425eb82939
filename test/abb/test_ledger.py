"""How earlier runs ended: of the last ones, and of those alone that were handed over how they were milled."""

from __future__ import annotations

import pytest

from doormill_ros.abb.handshake import ledger
from doormill_ros.abb.handshake.inbox import Submission
from doormill_ros.abb.handshake.ledger import RunLedger


def ended(runs: RunLedger, run_id: str, handed_over: bool = True) -> None:
    runs.begin(Submission(run_id, "door", b"file", 1))
    runs.end(handed_over, 0 if handed_over else 402, "ended")


def test_the_last_runs_alone_are_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ledger, "_OUTCOMES_REMEMBERED", 2)
    runs = RunLedger()
    for run_id in ("one", "two", "three"):
        ended(runs, run_id)
    assert [runs.outcome(run_id) is not None for run_id in ("one", "two", "three")] == [False, True, True]


def test_what_was_not_handed_over_was_not_milled() -> None:
    runs = RunLedger()
    ended(runs, "one", handed_over=False)
    before = runs.outcome("one")
    runs.end_milling("one", True, "milled")
    assert runs.outcome("one") == before
    ended(runs, "two")
    runs.end_milling("two", True, "milled")
    assert runs.outcome("two").milled is True
