"""The handshake's states, one at a time, on a transport in memory and a clock that the test moves."""

from __future__ import annotations

import ast
import itertools
import logging
import threading
from collections.abc import Iterable
from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.errors import TargetFileChecksumError
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.loop import HandshakeLoop
from doormill_ros.abb.handshake.sharing import SharedHandshake
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.handshake.state import HandshakeTimeouts
from doormill_ros.abb.link_errors import (
    AcknowledgeTimeoutError,
    ConnectionLostError,
    DoorNameError,
    EmptyTargetFileError,
    FileRefusedError,
    FileVerificationError,
    HandshakeBusyError,
    LinkError,
    MillingTimeoutError,
    NoRequestError,
    OtherRunError,
    ReadySignalError,
    RemoveError,
    RepeatedRunError,
    RequestWithdrawnError,
    RunAbortedError,
    SignalAccessError,
    StaleSubmissionError,
    SubmissionTimeoutError,
    UploadError,
)
from doormill_ros.abb.transport import Transport
from support.memory_transport import MemoryTransport
from support.waiting import LIMIT, until

FILE = b"1;2;3;1;0;0;0;0;0;0;0;\n" * 14
LIMITS = HandshakeTimeouts(submission=10.0, acknowledge=5.0, milling=100.0, link_loss=1.0)


class Clock:
    """A monotonic clock that stands still until the test moves it."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


class Scripted(MemoryTransport):
    """Logs every operation and runs what the test hangs on an operation's name before or after it."""

    def __init__(self, absent: Iterable[str] = ()) -> None:
        super().__init__(absent)
        self.log: list[str] = []
        self.before: dict[str, object] = {}
        self.after: dict[str, object] = {}

    def _done(self, text: str) -> None:
        action = self.after.get(text)
        if action is not None:
            action()

    def _note(self, text: str) -> None:
        self.log.append(text)
        action = self.before.get(text)
        if action is not None:
            action()

    def set_ready(self, value: bool) -> None:
        self._note(f"ready={int(value)}")
        super().set_ready(value)
        self._done(f"ready={int(value)}")

    def write_number(self, name: str, value: int) -> None:
        self._note(f"number={value}")
        super().write_number(name, value)

    def write_file(self, name: str, data: bytes) -> None:
        self._note("write")
        super().write_file(name, data)

    def read_file(self, name: str) -> bytes:
        self._note("read")
        return super().read_file(name)

    def remove_file(self, name: str) -> None:
        self._note("remove")
        super().remove_file(name)
        self._done("remove")

    def read_signal(self, name: str) -> bool:
        self._note(f"{name}?")
        return super().read_signal(name)

    def read_number(self, name: str) -> int:
        self._note(f"{name}?")
        return super().read_number(name)

    def read_request(self) -> bool:
        self._note("request?")
        return super().read_request()


class Cell:
    """A handshake with what drives it, on a controller that lacks the absent signals."""

    def __init__(self, absent: Iterable[str] = (), **options: object) -> None:
        self.clock = Clock()
        self.transport = Scripted(absent)
        self.states: list[State] = []
        self.handshake = SharedHandshake(
            self.transport, self.clock, LIMITS, on_change=lambda s: self.states.append(s.state), **options
        )
        self.handshake.on_start()
        self.runs = itertools.count(1)

    def request(self, value: bool) -> None:
        self.transport.set_signal(signals.REQUEST, value)

    def step(self) -> State:
        return self.handshake.step().state

    def submit(self, data: bytes = FILE) -> str:
        run_id = f"run-{next(self.runs)}"
        self.handshake.submit(run_id, "door", data)
        return run_id

    def to_requested(self) -> None:
        self.request(True)
        assert self.step() is State.REQUESTED

    def to_ready(self) -> str:
        self.to_requested()
        run_id = self.submit()
        assert self.step() is State.READY
        return run_id

    def assert_cleared(self) -> None:
        assert self.transport.signal(signals.READY) is False
        assert not self.transport._files


@pytest.fixture
def cell() -> Cell:
    return Cell()


def raising(error: Exception) -> object:
    def act() -> None:
        raise error

    return act


def raising_always(error: Exception) -> object:
    def act(*_: object) -> None:
        raise error

    return act


def test_memory_transport_is_a_transport() -> None:
    assert isinstance(MemoryTransport(), Transport)


def test_a_whole_run_in_the_order_that_keeps_the_robot_safe(cell: Cell) -> None:
    announced: list[bytes] = []
    cell.transport.before["ready=1"] = lambda: announced.append(cell.transport._files[signals.ORDER_FILE])
    run_id = cell.to_ready()
    assert cell.transport._files[signals.TARGET_FILE] == FILE
    cell.request(False)
    assert cell.step() is State.MILLING
    cell.assert_cleared()
    cell.transport.set_signal(signals.DONE, True)
    assert cell.step() is State.DONE
    assert cell.handshake.outcome(run_id).handed_over
    assert cell.states == [
        State.CLEARING,
        State.IDLE,
        State.REQUESTED,
        State.WRITING,
        State.VERIFYING,
        State.RAISING,
        State.READY,
        State.ACKNOWLEDGED,
        State.CLEARING,
        State.MILLING,
        State.DONE,
    ]
    order = [entry for entry in cell.transport.log if not entry.endswith("?")]
    clear = ["number=0", "ready=0", "remove", "read", "remove", "read"]
    former = ["read", "read"]  # the runs that the robot accepted and milled last
    mark = ["read"]
    handover = ["write", "read", "write", "read", *mark, "ready=1", *mark]
    assert order == [*clear, *former, *mark, *clear, *handover, *clear]
    assert announced == [f"{run_id}\n".encode()]


def test_a_start_clears_what_a_killed_process_left() -> None:
    transport = MemoryTransport()
    transport.set_ready(True)
    transport.write_file(signals.TARGET_FILE, FILE)
    handshake = Handshake(transport, Clock())
    assert transport.signal(signals.READY)
    assert handshake.on_start().state is State.IDLE
    assert not transport.signal(signals.READY)
    assert not transport._files


def test_a_request_raised_before_the_start_is_answered() -> None:
    transport = MemoryTransport()
    transport.set_signal(signals.REQUEST, True)
    handshake = Handshake(transport, Clock())
    handshake.on_start()
    assert handshake.step().state is State.REQUESTED
    assert handshake.snapshot.request_number == 1


OPTIONAL = (signals.FAULT, signals.BUSY, signals.DONE, signals.READY_NUMBER)


class TestProgramThatLacksSignals:
    """One older than they are; absent is low, and asked for once."""

    @pytest.mark.parametrize("absent", [*((name,) for name in OPTIONAL), OPTIONAL], ids="-".join)
    def test_is_handed_one_file_after_the_other(self, absent: tuple[str, ...]) -> None:
        cell = Cell(absent)
        for _ in range(2):
            run_id = cell.to_ready()
            assert cell.transport._files[signals.TARGET_FILE] == FILE
            cell.clock.now += LIMITS.watch
            assert cell.step() is State.READY
            cell.request(False)
            assert [cell.step() for _ in range(3)] == [State.MILLING] * 3
            cell.assert_cleared()
            assert cell.handshake.outcome(run_id).handed_over
            if signals.DONE not in absent:
                cell.transport.set_signal(signals.DONE, True)
                assert cell.step() is State.DONE
                cell.transport.set_signal(signals.DONE, False)
        assert cell.handshake.snapshot.error_code == 0
        asked = cell.transport.log
        for name in absent:
            told = asked.count("number=0") if name == signals.READY_NUMBER else 0
            assert told + asked.count(f"{name}?") == 1, name

    def test_that_marks_its_requests_is_told_no_number(self) -> None:
        cell = Cell(OPTIONAL)
        answer(cell, signals.REQUEST_FILE, "17\n")
        run_id = cell.to_ready()
        assert cell.transport._files[signals.ORDER_FILE] == f"{run_id}\n17\n".encode()
        assert "number=17" not in cell.transport.log
        answer(cell, signals.ACCEPTED_FILE, f"{run_id}\n17\n")
        cell.request(False)
        assert cell.step() is State.MILLING

    def test_is_known_by_the_reading_where_the_writing_is_refused(self) -> None:
        """A controller that answers the order with another code than "no such signal"."""
        cell = Cell((signals.READY_NUMBER,))
        cell.handshake._access._absent_signals.clear()
        cell.transport.log.clear()
        cell.transport.before["number=0"] = raising(SignalAccessError("refused"))
        cell.clock.now += LIMITS.watch
        cell.step()
        cell.to_ready()
        assert cell.transport.log.count(f"{signals.READY_NUMBER}?") == 1


class TestRobotThatMillsWhenTheBridgeStarts:
    """A former process handed run-7 over for request 17 and was killed."""

    @pytest.fixture
    def robot(self) -> MemoryTransport:
        transport = MemoryTransport()
        transport.set_signal(signals.BUSY, True)
        transport.write_file(signals.ACCEPTED_FILE, b"run-7\n17\n")
        return transport

    @pytest.fixture
    def handshake(self, robot: MemoryTransport) -> Handshake:
        return Handshake(robot, Clock(), LIMITS)

    def test_is_waited_for(self, robot: MemoryTransport, handshake: Handshake) -> None:
        assert handshake.on_start().state is State.MILLING
        assert handshake.snapshot.run_id == "run-7"
        assert handshake.outcome("run-7").milled is None
        assert handshake.step().state is State.MILLING
        robot.set_signal(signals.DONE, True)
        robot.set_signal(signals.BUSY, False)
        assert handshake.step().state is State.DONE
        assert handshake.outcome("run-7").milled is True

    def test_tells_its_fault(self, robot: MemoryTransport, handshake: Handshake) -> None:
        robot.set_signal(signals.FAULT, True)
        robot.write_file(signals.REFUSED_FILE, b"17\nThe spindle lost its speed.\n")
        handshake.on_start()
        assert handshake.step().state is State.FAILED
        assert "The spindle lost its speed." in handshake.snapshot.reason
        assert handshake.outcome("run-7").milled is False

    @pytest.mark.parametrize("noted", [True, False])
    def test_ends_unseen(self, robot: MemoryTransport, handshake: Handshake, noted: bool) -> None:
        handshake.on_start()
        if noted:
            robot.write_file(signals.MILLED_FILE, b"run-7\n")
        robot.set_signal(signals.BUSY, False)
        robot.set_signal(signals.REQUEST, True)
        assert handshake.step().state is State.REQUESTED
        assert handshake.outcome("run-7").milled is noted

    def test_ended_while_there_was_no_bridge(self, robot: MemoryTransport, handshake: Handshake) -> None:
        robot.write_file(signals.MILLED_FILE, b"run-7\n")
        robot.set_signal(signals.BUSY, False)
        assert handshake.on_start().state is State.IDLE
        assert handshake.outcome("run-7").milled is True

    def test_came_to_nothing_while_there_was_no_bridge(
        self, robot: MemoryTransport, handshake: Handshake
    ) -> None:
        robot.write_file(signals.MILLED_FILE, b"run-6\n")
        robot.set_signal(signals.BUSY, False)
        assert handshake.on_start().state is State.IDLE
        assert handshake.outcome("run-7") is None

    def test_takes_the_file_in_the_moment_of_the_start(
        self, robot: MemoryTransport, handshake: Handshake
    ) -> None:
        robot.set_signal(signals.REQUEST, True)
        handshake.on_start()
        assert handshake.step().state is State.REQUESTED
        robot.set_signal(signals.REQUEST, False)
        assert handshake.step().state is State.MILLING
        assert handshake.snapshot.run_id == "run-7"

    def test_is_no_matter_once_this_process_handed_over_a_file(
        self, robot: MemoryTransport, handshake: Handshake
    ) -> None:
        robot.set_signal(signals.REQUEST, True)
        handshake.on_start()
        handshake.step()
        handshake.submit("run-8", "door", FILE)
        assert handshake.step().state is State.READY
        handshake.abort("given up")
        robot.set_signal(signals.REQUEST, False)
        assert handshake.step().state is not State.MILLING
        assert handshake.outcome("run-8").handed_over is False


def test_no_request_no_file(cell: Cell) -> None:
    cell.step()
    with pytest.raises(NoRequestError, match="clamp the door"):
        cell.submit()
    cell.assert_cleared()


@pytest.mark.parametrize(
    ("run_id", "door_id", "data"), [("", "door", FILE), ("run", "", FILE), ("run", "door", b"")]
)
def test_nothing_empty_is_handed_over(cell: Cell, run_id: str, door_id: str, data: bytes) -> None:
    cell.to_requested()
    with pytest.raises(EmptyTargetFileError):
        cell.handshake.submit(run_id, door_id, data)


def test_of_two_files_at_once_the_second_is_refused(cell: Cell) -> None:
    cell.to_requested()
    cell.submit()
    with pytest.raises(HandshakeBusyError):
        cell.submit()
    assert cell.step() is State.READY
    with pytest.raises(HandshakeBusyError):
        cell.submit(b"another file")
    assert cell.transport._files[signals.TARGET_FILE] == FILE


def test_a_run_id_is_good_once(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.request(False)
    cell.step()
    cell.to_requested()
    with pytest.raises(RepeatedRunError):
        cell.handshake.submit(run_id, "door", FILE)


def test_a_file_for_an_earlier_request_is_refused(cell: Cell) -> None:
    cell.to_requested()
    number = cell.handshake.snapshot.request_number
    cell.request(False)
    cell.step()
    cell.step()
    cell.to_requested()
    with pytest.raises(StaleSubmissionError, match="new picture"):
        cell.handshake.submit("late", "door", FILE, request_number=number)


def test_a_request_that_falls_and_rises_between_two_looks_is_a_new_one(cell: Cell) -> None:
    cell.to_requested()
    number = cell.handshake.snapshot.request_number
    cell.submit()
    cell.request(False)
    cell.request(True)
    cell.step()
    assert cell.handshake.snapshot.request_number == number + 1
    assert cell.handshake.outcome("run-1").error_code == StaleSubmissionError.code
    for _ in range(3):
        cell.step()
    cell.assert_cleared()


def test_the_robots_request_number_is_echoed(cell: Cell) -> None:
    announced: list[bytes] = []
    cell.transport.before["ready=1"] = lambda: announced.append(cell.transport._files[signals.ORDER_FILE])
    cell.transport._files[signals.REQUEST_FILE] = b"17\n"
    run_id = cell.to_ready()
    assert announced == [f"{run_id}\n17\n".encode()]


def test_a_request_that_was_made_anew_unseen_is_told_by_its_number(cell: Cell) -> None:
    """The fall between two looks is never seen here, as when a polled program is started again."""
    cell.transport._files[signals.REQUEST_FILE] = b"17\n"
    cell.to_requested()
    cell.transport._files[signals.REQUEST_FILE] = b"18\n"
    run_id = cell.submit()
    cell.step()
    assert "ready=1" not in cell.transport.log
    assert cell.handshake.outcome(run_id).error_code == RequestWithdrawnError.code
    cell.step()
    assert cell.handshake.snapshot.state is State.REQUESTED
    assert cell.handshake.snapshot.request_number == 2
    cell.submit()
    assert cell.step() is State.READY


def answer(cell: Cell, name: str, text: str) -> None:
    """The robot program leaves a file."""
    cell.transport._files[name] = text.encode()


@pytest.mark.parametrize(
    ("accepted", "error"),
    [
        ("run-1\n17\n", None),
        (None, RequestWithdrawnError),
        ("run-0\n17\n", OtherRunError),
        ("run-1\n16\n", OtherRunError),
        ("run-1\n", OtherRunError),
    ],
)
def test_the_run_that_the_robot_accepted_is_compared(
    cell: Cell, accepted: str | None, error: type[LinkError] | None
) -> None:
    """A program that numbers its requests says which run it took; one that was stopped says nothing."""
    answer(cell, signals.REQUEST_FILE, "17\n")
    run_id = cell.to_ready()
    if accepted is not None:
        answer(cell, signals.ACCEPTED_FILE, accepted)
    cell.request(False)
    cell.step()
    outcome = cell.handshake.outcome(run_id)
    assert outcome.handed_over is (error is None)
    assert outcome.error_code == (0 if error is None else error.code)
    assert not cell.transport.signal(signals.READY)
    assert cell.transport.read_number(signals.READY_NUMBER) == 0


def test_ready_carries_the_number_of_the_request(cell: Cell) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    cell.to_ready()
    assert cell.transport.read_number(signals.READY_NUMBER) == 17
    assert cell.transport.log.index("number=17") < cell.transport.log.index("ready=1")


@pytest.mark.parametrize("when", ["ready=1", "number=17"])
def test_ready_falls_at_once_when_the_request_is_another_one_by_then(cell: Cell, when: str) -> None:
    """The robot program is started again in the instant between the last look and the raising."""
    answer(cell, signals.REQUEST_FILE, "17\n")
    cell.transport.before[when] = lambda: answer(cell, signals.REQUEST_FILE, "18\n")
    cell.to_requested()
    run_id = cell.submit()
    cell.step()
    assert cell.handshake.outcome(run_id).error_code == RequestWithdrawnError.code
    assert not cell.transport.signal(signals.READY)
    assert cell.transport.read_number(signals.READY_NUMBER) == 0
    assert cell.transport.log.count("ready=1") == 1
    cell.step()
    assert cell.handshake.snapshot.state is State.REQUESTED
    assert cell.handshake.snapshot.request_number == 2


def test_the_request_is_read_again_while_ready_is_high(cell: Cell) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    run_id = cell.to_ready()
    cell.step()
    answer(cell, signals.REQUEST_FILE, "18\n")
    cell.clock.now += LIMITS.watch
    cell.step()
    assert cell.handshake.outcome(run_id).error_code == RequestWithdrawnError.code
    assert not cell.transport.signal(signals.READY)
    assert cell.transport.read_number(signals.READY_NUMBER) == 0


@pytest.mark.parametrize("number", [0, 16, 18])
def test_a_number_that_somebody_else_wrote_ends_the_run(cell: Cell, number: int) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    run_id = cell.to_ready()
    cell.transport.write_number(signals.READY_NUMBER, number)
    cell.clock.now += LIMITS.watch
    cell.step()
    assert cell.handshake.outcome(run_id).error_code == ReadySignalError.code
    assert cell.transport.read_number(signals.READY_NUMBER) == 0


def test_the_reason_of_a_refusal_reaches_the_pc(cell: Cell) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    run_id = cell.to_ready()
    answer(cell, signals.REFUSED_FILE, "17\nThe target file is for another door:\ndoor_b\n")
    cell.transport.set_signal(signals.FAULT, True)
    cell.request(False)
    cell.step()
    outcome = cell.handshake.outcome(run_id)
    assert outcome.error_code == FileRefusedError.code
    assert outcome.reason.endswith("The target file is for another door: door_b")
    assert outcome.reason in cell.handshake.snapshot.reason


@pytest.mark.parametrize("text", ["16\nof the door before\n", "", None])
def test_the_reason_of_an_earlier_refusal_is_not_told(cell: Cell, text: str | None) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    run_id = cell.to_ready()
    if text is not None:
        answer(cell, signals.REFUSED_FILE, text)
    cell.transport.set_signal(signals.FAULT, True)
    cell.request(False)
    cell.step()
    assert cell.handshake.outcome(run_id).reason.endswith("its pendant says why")


def test_the_reason_of_a_fault_while_milling_reaches_the_pc(cell: Cell) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    run_id = cell.to_ready()
    answer(cell, signals.ACCEPTED_FILE, f"{run_id}\n17\n")
    cell.transport.set_signal(signals.BUSY, True)
    cell.request(False)
    assert cell.step() is State.MILLING
    answer(cell, signals.REFUSED_FILE, "17\nThe spindle lost its speed.\n")
    cell.transport.set_signal(signals.FAULT, True)
    assert cell.step() is State.FAILED
    assert cell.handshake.snapshot.reason.endswith("The spindle lost its speed.")


def test_the_name_of_the_door_is_passed_on(cell: Cell) -> None:
    told = cell.handshake.expect_door("door_a")
    assert not told.done()
    cell.step()
    assert told.result(0) is None
    assert cell.transport.read_file(signals.EXPECTED_FILE) == b"door_a\n#end\n"


def test_the_name_of_the_door_is_passed_on_in_any_state(cell: Cell) -> None:
    cell.to_ready()
    told = cell.handshake.expect_door("door_a")
    assert cell.step() is State.READY
    assert told.result(0) is None


def test_the_last_name_counts(cell: Cell) -> None:
    first, second = cell.handshake.expect_door("door_a"), cell.handshake.expect_door("door_b")
    cell.step()
    assert first.cancelled()
    assert second.result(0) is None
    assert cell.transport.read_file(signals.EXPECTED_FILE) == b"door_b\n#end\n"


@pytest.mark.parametrize("name", ["", "a\nb", "t\u00fcr", "x" * 41])
def test_a_name_that_the_controller_cannot_hold_is_refused(cell: Cell, name: str) -> None:
    assert isinstance(cell.handshake.expect_door(name).exception(0), DoorNameError)


def test_a_name_that_was_not_written_is_told(cell: Cell) -> None:
    def broken() -> None:
        raise UploadError("the disk is full")

    cell.transport.before["write"] = broken
    told = cell.handshake.expect_door("door_a")
    cell.step()
    assert isinstance(told.exception(0), UploadError)


def test_no_file_in_time(cell: Cell) -> None:
    cell.to_requested()
    cell.clock.now += LIMITS.submission - 0.1
    assert cell.step() is State.REQUESTED
    cell.clock.now += 0.2
    assert cell.step() is State.FAILED
    assert cell.handshake.snapshot.error_code == SubmissionTimeoutError.code
    cell.assert_cleared()


def test_a_failed_request_may_be_answered_again_until_it_falls(cell: Cell) -> None:
    cell.to_requested()
    cell.handshake.abort("door not found in the picture")
    assert cell.step() is State.FAILED
    assert cell.handshake.snapshot.reason == "door not found in the picture"
    assert cell.handshake.snapshot.error_code == RunAbortedError.code
    assert cell.handshake.snapshot.accepts_submission
    cell.submit()
    assert cell.step() is State.READY
    cell.handshake.abort("operator")
    cell.step()
    cell.request(False)
    assert cell.step() is State.IDLE
    assert not cell.handshake.snapshot.accepts_submission


@pytest.mark.parametrize("before", [State.IDLE, State.DONE, State.FAILED])
def test_a_request_that_rises_while_its_signal_cannot_be_read_is_answered(
    cell: Cell, before: State, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Refused by a controller that is there: nothing was missed, and still this request is a new one."""
    if before is not State.IDLE:
        cell.to_ready()
        cell.request(False)
        cell.step()
        cell.transport.set_signal(signals.DONE if before is State.DONE else signals.FAULT, True)
        assert cell.step() is before
    number = cell.handshake.snapshot.request_number
    cell.request(True)
    refusals = [SignalAccessError("no")]
    read = cell.transport.read_signal

    def refuse_once(name: str) -> bool:
        if refusals:
            raise refusals.pop()
        return read(name)

    monkeypatch.setattr(cell.transport, "read_signal", refuse_once)
    cell.step()
    assert not refusals
    for _ in range(3):
        cell.clock.now += 1.0
        cell.step()
    assert cell.handshake.snapshot.state is State.REQUESTED
    assert cell.handshake.snapshot.request_number == number + 1


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize(
    ("before", "after", "new"), [("17", "17", False), ("17", "18", True), ("", "", True)], ids=str
)
def test_a_request_outlasts_a_break_of_the_link_when_the_robots_mark_is_the_same(
    cell: Cell, monkeypatch: pytest.MonkeyPatch, before: str, after: str, new: bool, late: bool
) -> None:
    """What was measured for it is good still, also when the door had to wait for another robot until then."""
    if before:
        answer(cell, signals.REQUEST_FILE, f"{before}\n")
    cell.to_requested()
    first = cell.handshake.snapshot
    if late:
        cell.clock.now += LIMITS.submission
        assert cell.step() is State.FAILED
    with monkeypatch.context() as broken:
        broken.setattr(cell.transport, "read_ready", raising_always(ConnectionLostError("no answer")))
        cell.clock.now += LIMITS.watch
        assert cell.step() is State.CLEARING
        if after:
            answer(cell, signals.REQUEST_FILE, f"{after}\n")
    for _ in range(3):
        cell.clock.now += LIMITS.retry_last
        cell.step()
    now = cell.handshake.snapshot
    assert now.request_number == first.request_number + new
    assert now.request
    assert now.state is (State.FAILED if late and not new else State.REQUESTED)
    if new:
        with pytest.raises(StaleSubmissionError):
            cell.handshake.submit("run-1", "door", FILE, first.request_number)
    else:
        assert now.times["requested"] == first.since
        cell.handshake.submit("run-1", "door", FILE, first.request_number)
        assert cell.step() is State.READY


def test_a_marked_request_that_falls_in_a_break_of_the_link_is_over(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer(cell, signals.REQUEST_FILE, "17\n")
    cell.to_requested()
    with monkeypatch.context() as broken:
        broken.setattr(cell.transport, "read_ready", raising_always(ConnectionLostError("no answer")))
        cell.clock.now += LIMITS.watch
        assert cell.step() is State.CLEARING
        cell.request(False)
    cell.clock.now += LIMITS.retry_last
    assert cell.step() is State.FAILED
    assert not cell.handshake.snapshot.accepts_submission
    assert cell.step() is State.IDLE


def test_an_abort_with_nothing_to_abort_does_not_hit_the_next_run(cell: Cell) -> None:
    cell.handshake.abort("too early")
    cell.step()
    cell.to_ready()


@pytest.mark.parametrize("moment", ["write", "read", "ready=1"])
def test_an_abort_while_the_file_is_under_way(cell: Cell, moment: str) -> None:
    cell.to_requested()
    cell.transport.before[moment] = lambda: cell.handshake.abort("wrong door")
    run_id = cell.submit()
    cell.step()
    cell.transport.before.clear()
    assert cell.step() is State.FAILED
    assert cell.handshake.outcome(run_id).error_code == RunAbortedError.code
    cell.assert_cleared()


@pytest.mark.parametrize("moment", ["write", "read"])
def test_a_request_withdrawn_while_the_file_is_under_way(cell: Cell, moment: str) -> None:
    cell.to_requested()
    cell.transport.before[moment] = lambda: cell.request(False)
    run_id = cell.submit()
    cell.step()
    assert "ready=1" not in cell.transport.log
    assert cell.handshake.outcome(run_id).error_code == RequestWithdrawnError.code
    cell.assert_cleared()


def test_a_file_that_reads_back_differently_is_never_announced(cell: Cell) -> None:
    cell.to_requested()
    cell.transport.before["read"] = lambda: cell.transport._files.update({signals.TARGET_FILE: FILE[:-1]})
    run_id = cell.submit()
    cell.step()
    cell.transport.before.clear()
    assert "ready=1" not in cell.transport.log
    outcome = cell.handshake.outcome(run_id)
    assert outcome.error_code == FileVerificationError.code
    assert f"first difference at byte {len(FILE) - 1}" in outcome.reason


def test_a_file_whose_content_is_refused_is_never_announced() -> None:
    def check(data: bytes, run_id: str, door_id: str) -> None:
        assert (data, run_id, door_id) == (FILE, "run-1", "door")
        raise TargetFileChecksumError("checksum differs")

    cell = Cell(check=check)
    cell.to_requested()
    run_id = cell.submit()
    assert cell.step() is State.FAILED
    assert "ready=1" not in cell.transport.log
    assert "checksum differs" in cell.handshake.outcome(run_id).reason


def test_ready_that_does_not_read_back_high(cell: Cell) -> None:
    cell.to_requested()
    cell.transport.set_ready = lambda value: None
    run_id = cell.submit()
    assert cell.step() is State.FAILED
    assert cell.handshake.outcome(run_id).error_code == ReadySignalError.code


def test_ready_raised_by_somebody_else_is_noticed(cell: Cell) -> None:
    cell.transport.set_ready(True)
    cell.clock.now += LIMITS.watch
    assert cell.step() is State.IDLE
    cell.assert_cleared()


def test_ready_that_cannot_be_lowered_keeps_everything_waiting(cell: Cell) -> None:
    cell.to_ready()
    cell.transport.before["ready=0"] = raising(UploadError("disk full"))
    cell.handshake.abort("operator")
    assert cell.step() is State.CLEARING
    for _ in range(20):
        cell.clock.now += 1.0
        assert cell.step() is State.CLEARING
    assert "disk full" in cell.handshake.snapshot.reason
    with pytest.raises(HandshakeBusyError):
        cell.submit()
    cell.transport.before.clear()
    cell.clock.now += LIMITS.retry_last
    # The request may have fallen and risen meanwhile, so it counts as new.
    assert cell.step() is State.FAILED
    assert cell.step() is State.REQUESTED
    assert cell.handshake.snapshot.request_number == 2
    cell.assert_cleared()


@pytest.mark.parametrize("order", ["ready=0", "remove"])
def test_what_reads_back_as_cleared_is_cleared_whatever_the_order_was_answered(
    cell: Cell, order: str
) -> None:
    """A controller that refuses to lower what is low, or to remove what is not there."""
    cell.to_ready()
    cell.transport.after[order] = raising(SignalAccessError("refused"))
    cell.handshake.abort("operator")
    assert cell.step() is State.FAILED
    cell.assert_cleared()


@pytest.mark.parametrize("removals", [1, 2])
def test_a_file_that_stays_keeps_everything_waiting_with_the_reason(cell: Cell, removals: int) -> None:
    """Target file and order file; the first of them alone, then the second."""
    cell.to_ready()
    files = dict(cell.transport._files)
    kept = [signals.TARGET_FILE, signals.ORDER_FILE][removals - 1]

    def refuse() -> None:
        cell.transport._files[kept] = files[kept]
        raise RemoveError("status 406")

    cell.transport.after["remove"] = refuse
    cell.handshake.abort("operator")
    assert cell.step() is State.CLEARING
    assert "status 406" in cell.handshake.snapshot.reason


def test_a_request_that_comes_to_nothing_is_not_told_of_the_run_before(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.request(False)
    assert cell.step() is State.MILLING
    assert cell.handshake.snapshot.run_id == run_id
    cell.to_requested()
    assert cell.handshake.snapshot.run_id == cell.handshake.snapshot.door_id == ""
    cell.clock.now += LIMITS.submission
    assert cell.step() is State.FAILED
    assert cell.handshake.snapshot.run_id == ""
    assert cell.handshake.outcome(run_id).handed_over


@pytest.mark.parametrize("noted", [True, False])
def test_an_end_that_came_and_went_between_two_looks_is_read_from_the_robots_note(
    cell: Cell, noted: bool
) -> None:
    """Done rises and falls, the next request rises; the PC was busy with something else."""
    run_id = cell.to_ready()
    cell.request(False)
    assert cell.step() is State.MILLING
    assert cell.handshake.outcome(run_id).milled is None
    answer(cell, signals.MILLED_FILE, f"{run_id}\n" if noted else "the-run-before\n")
    cell.states.clear()
    cell.request(True)
    assert cell.step() is State.REQUESTED
    assert cell.states == [*([State.DONE] if noted else []), State.REQUESTED]
    assert cell.handshake.outcome(run_id).milled is noted


def test_a_request_that_rose_while_the_run_before_was_being_cleared_is_the_next(cell: Cell) -> None:
    cell.to_ready()
    cell.transport.after["ready=0"] = lambda: cell.request(True)
    cell.request(False)
    assert cell.step() is State.MILLING
    assert cell.step() is State.REQUESTED


def test_the_attempts_to_clear_back_off(cell: Cell) -> None:
    cell.to_ready()
    cell.transport.before["ready=0"] = raising(ConnectionLostError("cable"))
    cell.handshake.abort("operator")
    cell.transport.log.clear()
    for _ in range(1000):
        cell.step()
        cell.clock.now += 0.01
    assert 10 <= cell.transport.log.count("ready=0") <= 20


def test_no_acknowledgement_in_time(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.clock.now += LIMITS.acknowledge
    assert cell.step() is State.FAILED
    assert cell.handshake.outcome(run_id).error_code == AcknowledgeTimeoutError.code
    cell.assert_cleared()


def test_a_short_loss_of_the_link_while_ready_is_bridged(cell: Cell) -> None:
    cell.to_ready()
    cell.transport.before["request?"] = raising(ConnectionLostError("cable"))
    cell.step()
    cell.clock.now += 0.9 * LIMITS.link_loss
    assert cell.step() is State.READY
    cell.transport.before.clear()
    cell.request(False)
    assert cell.step() is State.MILLING


def test_a_long_loss_of_the_link_while_ready_ends_the_run(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.transport.before["request?"] = raising(ConnectionLostError("cable"))
    cell.step()
    cell.clock.now += LIMITS.link_loss
    cell.step()
    outcome = cell.handshake.outcome(run_id)
    assert outcome.error_code == ConnectionLostError.code
    assert "look at the robot" in outcome.reason
    cell.assert_cleared()


class TestFileTakenUnseen:
    """The robot took the file between its last look at ready and the moment it was to be taken back."""

    @staticmethod
    def take(cell: Cell, run_id: str) -> None:
        cell.transport.write_file(signals.ACCEPTED_FILE, f"{run_id}\n17\n".encode("ascii"))
        cell.transport.set_signal(signals.BUSY, True)
        cell.request(False)

    @staticmethod
    def assert_milled(cell: Cell, run_id: str) -> None:
        assert cell.handshake.snapshot.state is State.MILLING
        assert cell.handshake.snapshot.run_id == run_id
        assert cell.handshake.snapshot.door_id == "door"
        assert "taken the file before" in cell.handshake.snapshot.reason
        assert cell.handshake.outcome(run_id).handed_over
        assert cell.handshake.outcome(run_id).milled is None
        cell.transport.before.clear()
        cell.transport.set_signal(signals.DONE, True)
        cell.transport.set_signal(signals.BUSY, False)
        assert cell.step() is State.DONE
        assert cell.handshake.outcome(run_id).milled is True

    def lose_link(self, cell: Cell) -> None:
        cell.transport.before["request?"] = raising(ConnectionLostError("cable"))
        cell.step()
        cell.clock.now += LIMITS.link_loss

    def test_while_the_link_is_gone(self, cell: Cell) -> None:
        run_id = cell.to_ready()
        self.lose_link(cell)
        self.take(cell, run_id)
        cell.step()
        self.assert_milled(cell, run_id)

    def test_and_milled_while_the_link_is_gone(self, cell: Cell) -> None:
        run_id = cell.to_ready()
        self.lose_link(cell)
        self.take(cell, run_id)
        cell.transport.write_file(signals.MILLED_FILE, f"{run_id}\n".encode("ascii"))
        cell.transport.set_signal(signals.BUSY, False)
        cell.step()
        assert cell.handshake.outcome(run_id).milled is True
        assert cell.handshake.snapshot.state is not State.MILLING

    @pytest.mark.parametrize("moment", ["before", "after"])
    def test_when_it_is_given_up(self, cell: Cell, moment: str) -> None:
        """Its request falls before the PC looks at it again, or only after it has lowered ready."""
        run_id = cell.to_ready()
        cell.handshake.abort("wrong door")
        if moment == "before":
            self.take(cell, run_id)
            cell.step()
        else:
            assert cell.step() is State.FAILED
            assert cell.handshake.outcome(run_id).error_code == RunAbortedError.code
            self.take(cell, run_id)
            cell.step()
        self.assert_milled(cell, run_id)

    def test_when_nothing_was_read_for_too_long(self, cell: Cell) -> None:
        run_id = cell.to_ready()
        cell.clock.now += LIMITS.acknowledge
        assert cell.step() is State.FAILED
        self.take(cell, run_id)
        cell.step()
        self.assert_milled(cell, run_id)

    def test_is_not_thought_of_a_file_that_it_gave_back(self, cell: Cell) -> None:
        """It is busy, but with nothing of this run."""
        run_id = cell.to_ready()
        cell.handshake.abort("wrong door")
        assert cell.step() is State.FAILED
        self.take(cell, "another")
        assert cell.step() is State.IDLE
        assert cell.handshake.outcome(run_id).error_code == RunAbortedError.code

    def test_is_not_thought_of_once_another_file_was_handed_over(self, cell: Cell) -> None:
        first = cell.to_ready()
        cell.handshake.abort("wrong door")
        assert cell.step() is State.FAILED
        cell.submit()
        assert cell.step() is State.READY
        cell.handshake.abort("wrong door too")
        assert cell.step() is State.FAILED
        self.take(cell, first)
        assert cell.step() is State.IDLE


def test_a_file_refused_by_the_robot(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.transport.set_signal(signals.FAULT, True)
    cell.request(False)
    cell.step()
    assert cell.handshake.outcome(run_id).error_code == FileRefusedError.code
    cell.assert_cleared()


def test_a_fault_while_milling(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.request(False)
    cell.step()
    cell.transport.set_signal(signals.FAULT, True)
    assert cell.step() is State.FAILED
    assert "while milling" in cell.handshake.snapshot.reason
    assert cell.handshake.outcome(run_id).handed_over


def test_milling_that_never_ends(cell: Cell) -> None:
    cell.to_ready()
    cell.request(False)
    cell.step()
    cell.clock.now += LIMITS.milling
    assert cell.step() is State.FAILED
    assert cell.handshake.snapshot.error_code == MillingTimeoutError.code


def test_the_next_request_may_come_without_a_done_signal(cell: Cell) -> None:
    cell.to_ready()
    cell.request(False)
    assert cell.step() is State.MILLING
    cell.to_ready()
    assert cell.handshake.snapshot.request_number == 2


def test_an_operation_in_doubt_is_waited_for() -> None:
    cell = Cell()
    cell.transport.in_doubt_time = 8.0
    cell.to_requested()
    late = raising(ConnectionLostError("cable"))
    cell.transport.before["ready=1"] = late
    cell.submit()
    assert cell.step() is State.CLEARING
    cell.clock.now += 4.0
    MemoryTransport.set_ready(cell.transport, True)  # the lost order arrives after all
    assert cell.step() is State.CLEARING
    cell.assert_cleared()
    cell.clock.now += 4.1
    cell.transport.before.clear()
    assert cell.step() is State.FAILED
    cell.assert_cleared()


def test_closing_clears() -> None:
    cell = Cell()
    cell.to_ready()
    cell.handshake.close()
    cell.assert_cleared()


@pytest.mark.parametrize("operation", ["number=0", "ready=0", f"{signals.READY_NUMBER}?", "remove", "read"])
def test_closing_over_a_dead_link_closes_the_transport(
    cell: Cell, operation: str, caplog: pytest.LogCaptureFixture
) -> None:
    cell.to_ready()
    cell.transport.before[operation] = raising(ConnectionLostError("cable"))
    with caplog.at_level(logging.ERROR):
        cell.handshake.close()
    assert cell.transport.closed
    assert "not cleared: cable" in caplog.text


def test_who_gives_way_while_the_robot_mills_leaves_it_alone_and_says_that_it_may_mill(cell: Cell) -> None:
    run_id = cell.to_ready()
    cell.transport.set_signal(signals.BUSY, True)
    cell.request(False)
    assert cell.step() is State.MILLING
    answer(cell, signals.ACCEPTED_FILE, f"{run_id}\n")
    cell.transport.log.clear()
    cell.handshake.rest("another bridge goes to the controller")
    assert cell.handshake.snapshot.state is State.IDLE
    assert cell.transport.log == []
    outcome = cell.handshake.outcome(run_id)
    assert (outcome.handed_over, outcome.milled) == (True, False)  # nobody here sees its end
    assert outcome.reason.startswith("another bridge goes to the controller")
    assert "look at the robot" in outcome.reason
    # The other one goes: this bridge takes the run up again, and sees its end after all.
    assert cell.handshake.on_start().state is State.MILLING
    cell.transport.set_signal(signals.DONE, True)
    assert cell.step() is State.DONE
    assert cell.handshake.outcome(run_id).milled is True


def test_times_of_the_stages_are_in_order(cell: Cell) -> None:
    cell.transport.before["write"] = lambda: setattr(cell.clock, "now", cell.clock.now + 0.5)
    cell.to_ready()
    times = cell.handshake.snapshot.times
    assert times["verifying"] - times["writing"] == pytest.approx(0.5)
    assert times["requested"] <= times["writing"] <= times["verifying"] <= times["raising"] <= times["ready"]


def test_the_loop_answers_and_stops_without_help() -> None:
    transport = MemoryTransport()
    reached = {state: threading.Event() for state in State}
    handshake = SharedHandshake(transport, on_change=lambda s: reached[s.state].set())
    with HandshakeLoop(handshake) as loop:
        assert reached[State.IDLE].wait(LIMIT)
        transport.set_signal(signals.REQUEST, True)
        assert reached[State.REQUESTED].wait(LIMIT)
        handshake.submit("run", "door", FILE)
        assert reached[State.READY].wait(LIMIT)
        transport.set_signal(signals.REQUEST, False)
        assert reached[State.MILLING].wait(LIMIT)
        transport.set_signal(signals.REQUEST, True)
        assert loop.alive
    assert not loop.alive
    assert loop.failure is None
    assert not transport.signal(signals.READY)


LOOKS = 20


class Looks(threading.Event):
    """Counts how often a loop that is held looks whether it is released."""

    def __init__(self, loop: HandshakeLoop) -> None:
        super().__init__()
        self.count = 0
        if loop._released.is_set():
            self.set()
        loop._released = self

    def wait(self, timeout: float | None = None) -> bool:
        self.count += 1
        return super().wait(timeout)


def test_a_loop_that_is_held_leaves_the_file_of_another_bridge_alone() -> None:
    transport = Scripted()
    transport.write_file(signals.TARGET_FILE, b"of another bridge")
    transport.set_signal(signals.READY, True)
    loop = HandshakeLoop(SharedHandshake(transport), idle_wait=0.001, held=True)
    looks = Looks(loop)
    transport.log.clear()
    with loop:
        until(lambda: looks.count > LOOKS)
    assert not loop.alive
    assert transport.log == []
    assert transport.closed
    assert transport.signal(signals.READY)
    assert transport._files[signals.TARGET_FILE] == b"of another bridge"


def test_a_loop_that_is_held_in_a_run_takes_its_own_file_away_and_begins_anew_when_released() -> None:
    transport = Scripted()
    handshake = SharedHandshake(transport)
    loop = HandshakeLoop(handshake, idle_wait=0.001)
    looks = Looks(loop)
    with loop:
        transport.set_signal(signals.REQUEST, True)
        until(lambda: handshake.snapshot.accepts_submission)
        handshake.submit("run", "door", FILE)
        until(lambda: handshake.snapshot.state is State.READY)
        loop.hold()
        until(lambda: handshake.snapshot.state is State.IDLE)
        assert not transport.signal(signals.READY)
        assert not transport._files
        assert handshake.outcome("run").error_code != 0
        transport.write_file(signals.TARGET_FILE, b"of another bridge")
        transport.log.clear()
        seen = looks.count
        until(lambda: looks.count > seen + LOOKS)
        assert transport.log == []
        assert transport._files
        loop.release()
        until(lambda: handshake.snapshot.accepts_submission)
        assert not transport._files


def test_a_programming_error_in_the_loop_leaves_the_controller_cleared() -> None:
    transport = MemoryTransport()
    handshake = SharedHandshake(transport)
    ready = threading.Event()
    handshake._on_change = lambda s: ready.set() if s.state is State.READY else None
    loop = HandshakeLoop(handshake)
    transport.set_signal(signals.REQUEST, True)
    loop.start()
    until(lambda: handshake.snapshot.accepts_submission)
    handshake.submit("run", "door", FILE)
    assert ready.wait(LIMIT)
    seen: list[object] = []
    hook, threading.excepthook = threading.excepthook, seen.append
    try:
        handshake._step_ready = raising(ZeroDivisionError())
        loop._thread.join(LIMIT)
    finally:
        threading.excepthook = hook
    assert isinstance(loop.failure, ZeroDivisionError)
    assert not transport.signal(signals.READY)
    assert not transport._files


def test_no_part_of_the_link_looks_at_the_wall_clock() -> None:
    """A clock step cannot matter to code that never asks the wall clock."""
    package = Path(__file__).resolve().parents[2] / "doormill_ros" / "abb"
    files = [
        *package.glob("handshake/*.py"),
        *package.glob("transport*.py"),
        *package.glob("transports/*.py"),
    ]
    files += [package / "backoff.py", package / "target_file" / "target_file.py"]
    assert len(files) >= 15
    forbidden = {("time", "time"), ("time", "time_ns"), ("datetime", "now"), ("date", "today")}
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute):
                owner = getattr(node.value, "id", getattr(node.value, "attr", ""))
                assert (owner, node.attr) not in forbidden, f"{path}: {owner}.{node.attr}"
