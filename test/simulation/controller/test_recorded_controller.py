"""The recorded controller does what the controller of the run did, in that order."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.abb import signals
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.recorded_controller import (
    RecordedController,
    RecordedEvent,
    controller_events,
    with_end,
)
from support.waiting import until

S = 1_000_000_000  # ns
MILLED = [
    "clearing",
    "idle",
    "requested",
    "writing",
    "verifying",
    "raising",
    "ready",
    "acknowledged",
    "milling",
]


def test_a_milled_door() -> None:
    states = [(n * S, state) for n, state in enumerate([*MILLED, "done"], start=10)]
    requests = [(10 * S, False), (12 * S, True), (16 * S, True), (17 * S, False)]
    assert controller_events(11 * S, requests, states) == [
        RecordedEvent(signals.REQUEST, True, 1.0),
        RecordedEvent(signals.REQUEST, False, 1.0, ready=True),
        RecordedEvent(signals.DONE, True, 2.0, ready=False),
    ]


def test_a_fault_while_milling() -> None:
    states = [(n * S, state) for n, state in enumerate([*MILLED, "failed", "idle"], start=10)]
    events = controller_events(10 * S, [(12 * S, True), (17 * S, False)], states)
    assert [(e.signal, e.value) for e in events][-1] == (signals.FAULT, True)


def test_a_request_that_was_withdrawn_does_not_wait_for_a_ready_that_never_came() -> None:
    states = [(12 * S, "requested"), (14 * S, "failed"), (15 * S, "requested")]
    events = controller_events(10 * S, [(12 * S, True), (14 * S, False), (15 * S, True)], states)
    assert [(e.value, e.delay, e.ready) for e in events] == [
        (True, 2.0, None),
        (False, 2.0, None),
        (True, 1.0, None),
    ]


def test_what_comes_after_the_end_is_no_part_of_the_run() -> None:
    states = [(n * S, state) for n, state in enumerate([*MILLED, "done", "requested"], start=10)]
    events = controller_events(10 * S, [(12 * S, True), (17 * S, False), (20 * S, True)], states)
    assert [(e.signal, e.value) for e in events] == [
        (signals.REQUEST, True),
        (signals.REQUEST, False),
        (signals.DONE, True),
    ]
    assert with_end(events, signals.FAULT) == events


def test_an_end_that_was_not_recorded_is_added() -> None:
    events = [RecordedEvent(signals.REQUEST, True, 1.0)]
    assert with_end(events, signals.DONE) == [*events, RecordedEvent(signals.DONE, True, 0.0, ready=False)]


def test_a_file_read_before_ready_was_told_is_still_waited_for() -> None:
    """The controller may have lowered its request when the bridge tells that ready is high."""
    states = [(n * S, state) for n, state in enumerate([*MILLED, "done"], start=10)]
    told = {state: stamp for stamp, state in states}
    (request, answer, _) = controller_events(
        10 * S, [(told["requested"], True), (told["ready"], False)], states
    )
    assert (request.value, request.ready) == (True, None)
    assert (answer.value, answer.ready) == (False, True)


def test_a_refusal_before_milling_is_no_end_of_milling() -> None:
    assert controller_events(0, [], [(S, "requested"), (2 * S, "failed")]) == []


_STAMPS = st.integers(0, 100)
_STATES = st.tuples(_STAMPS, st.sampled_from([*MILLED, "done", "failed"]))


@given(st.lists(st.tuples(_STAMPS, st.booleans())), st.lists(_STATES))
def test_the_request_alternates_whatever_was_recorded(
    requests: list[tuple[int, bool]], states: list[tuple[int, str]]
) -> None:
    events = controller_events(0, requests, states)
    edges = [e.value for e in events if e.signal == signals.REQUEST]
    assert edges == [n % 2 == 0 for n in range(len(edges))]
    assert all(e.delay >= 0.0 for e in events)


def _wait(io: FolderIo, signal: str, value: int) -> None:
    until(lambda: io.read(signal) == value, lambda: f"{signal} never became {value}")


def test_it_waits_for_ready_and_ends_the_program(tmp_path: Path) -> None:
    io = FolderIo(tmp_path)
    events = [
        RecordedEvent(signals.REQUEST, True, 1000.0),
        RecordedEvent(signals.REQUEST, False, 1000.0, ready=True),
        RecordedEvent(signals.DONE, True, 1000.0, ready=False),
    ]
    with RecordedController(tmp_path, events, float("inf")) as controller:
        assert io.read(signals.REQUEST) == 0
        controller.begin()
        _wait(io, signals.REQUEST, 1)
        assert io.read(signals.DONE) == 0
        io.write(signals.READY, 1)
        _wait(io, signals.REQUEST, 0)
        assert io.read(signals.DONE) == 0
        io.write(signals.READY, 0)
        _wait(io, signals.DONE, 1)


def test_it_ends_while_it_waits(tmp_path: Path) -> None:
    events = [RecordedEvent(signals.REQUEST, True, 1e6), RecordedEvent(signals.DONE, True, 0.0)]
    with RecordedController(tmp_path, events, 1.0) as controller:
        controller.begin()
    assert FolderIo(tmp_path).read(signals.DONE) == 0
