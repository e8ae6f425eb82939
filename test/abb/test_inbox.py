"""Which files are taken: one at a time, each run once, of the runs that are remembered."""

from __future__ import annotations

import pytest

from doormill_ros.abb.handshake import inbox
from doormill_ros.abb.handshake.inbox import Inbox, Submission
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState
from doormill_ros.abb.link_errors import HandshakeBusyError, RepeatedRunError

REQUESTED = HandshakeSnapshot(HandshakeState.REQUESTED, "requested", 0.0, request=True, request_number=1)


def put(box: Inbox, run_id: str) -> None:
    box.put(Submission(run_id, "door", b"file", 1), REQUESTED)


def test_a_second_file_waits_for_the_first() -> None:
    box = Inbox()
    put(box, "one")
    with pytest.raises(HandshakeBusyError):
        put(box, "two")
    taken = box.take()
    assert taken is not None
    assert taken.run_id == "one"
    put(box, "two")  # Refused is not submitted: its run id is free.
    assert box.take() is not None
    assert box.take() is None


def test_the_oldest_run_alone_is_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inbox, "_RUNS_REMEMBERED", 2)
    box = Inbox()
    for run_id in ("one", "two", "three"):
        put(box, run_id)
        box.take()
    for run_id in ("two", "three"):
        with pytest.raises(RepeatedRunError):
            put(box, run_id)
    put(box, "one")
