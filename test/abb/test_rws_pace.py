"""A controller is asked no faster than it answers."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.abb.transports.rws_pace import MOST, RequestPace
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.web_services import link_to

ANSWERED, A_SECOND = 20, 1.0  #: requests that RobotWare 6 was seen to answer in so long [s]
FILE = b"1;2;3;1;0;0;0;0;0;0;0;\n" * 14


class Clock:
    """Time that passes by sleeping and by what a test lets requests take."""

    def __init__(self) -> None:
        self.now = 100.0
        self.slept: list[float] = []

    def __call__(self) -> float:
        return self.now

    def sleep(self, time: float) -> None:
        assert time > 0.0
        self.slept.append(time)
        self.now += time


times = st.floats(0.0, 0.4)


@given(st.lists(st.tuples(times, times, times, st.integers(1, 2)), min_size=2 * MOST, max_size=120))
def test_no_second_sees_more_requests_than_allowed(exchanges: list[tuple[float, float, float, int]]) -> None:
    """Whenever they arrive between sending and answer."""
    clock = Clock()
    pace = RequestPace(clock, clock.sleep)
    arrived = []
    for idle, there, back, requests in exchanges:
        clock.now += idle
        pace.wait(2)
        clock.now += there
        arrived += [clock.now] * requests
        clock.now += back
        pace.answered(requests)
    spans = [beyond - first for first, beyond in zip(arrived, arrived[ANSWERED:], strict=False)]
    assert len(spans) >= ANSWERED
    assert min(spans) >= A_SECOND * (1.0 - 1e-9)


def test_a_handover_after_a_pause_is_not_held_up() -> None:
    clock = Clock()
    pace = RequestPace(clock, clock.sleep)
    for _ in range(MOST - 1):
        pace.wait(2)
        pace.answered()
    assert clock.slept == []
    pace.wait(2)
    assert clock.slept == [A_SECOND]


@pytest.mark.parametrize("version", [1, 2])
def test_a_controller_that_refuses_more_is_never_asked_for_more(tmp_path: Path, version: int) -> None:
    """Two doors are handed over and their ends looked for, as fast as the link allows."""
    with RwsServer(Cabinet.create(tmp_path / "home"), version) as server:
        server.services.behaviour.requests_per_second = ANSWERED
        link = link_to(server)
        link.in_doubt_time = 0.0  # nobody was here before
        handshake = Handshake(link)
        handshake.on_start()
        for run in ("run-1", "run-2"):
            server.cabinet.set_value(signals.REQUEST, 1)
            steps_to(handshake, HandshakeState.REQUESTED)
            handshake.submit(run, "door", FILE)
            steps_to(handshake, HandshakeState.READY)
            server.cabinet.set_value(signals.REQUEST, 0)
            steps_to(handshake, HandshakeState.MILLING)
            server.cabinet.set_value(signals.DONE, 1)
            steps_to(handshake, HandshakeState.DONE)
            server.cabinet.set_value(signals.DONE, 0)
            assert handshake.outcome(run).handed_over
        handshake.close()
        statuses = [status for _, _, status in server.services.requests]
        assert len(statuses) > 2 * MOST
        assert 503 not in statuses


def steps_to(handshake: Handshake, state: HandshakeState) -> None:
    """Step until the state is reached."""
    while (found := handshake.step().state) is not state:
        assert found is not HandshakeState.FAILED, handshake.snapshot.reason
        handshake.wait(0.01)
