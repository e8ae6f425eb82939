"""Random histories of robot, operator, planner and a failing link: ready never announces a wrong file."""

from __future__ import annotations

import hashlib

import hypothesis.strategies as st
from hypothesis import HealthCheck, settings
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import CLEARED, HandshakeTimeouts
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.link_errors import ConnectionLostError, LinkError, UploadError
from support.memory_transport import MemoryTransport

LIMITS = HandshakeTimeouts(submission=8.0, acknowledge=4.0, milling=20.0, link_loss=0.5, watch=0.2)
DOUBT = 2.0
FAULTS = ("lost", "done but lost", "late", "torn", "silently torn", "refused")


def render(placement: int, run: int) -> bytes:
    """A file that names the clamping it was made for and that shows when a byte is missing."""
    body = b"placement=%d;run=%d;" % (placement, run) + b"x" * 40
    return body + hashlib.sha256(body).hexdigest().encode()


def complete(data: bytes) -> bool:
    return len(data) > 64 and hashlib.sha256(data[:-64]).hexdigest().encode() == data[-64:]


class FailingLink(MemoryTransport):
    """Loses, repeats late or tears the operation that a fault was armed for."""

    in_doubt_time = DOUBT

    def __init__(self, now: object) -> None:
        super().__init__()
        self.now = now
        self.armed: list[str] = []
        self.late: list[tuple[float, object]] = []
        self.delay = 1.0

    def arrive(self) -> None:
        due = [action for at, action in self.late if at <= self.now()]
        self.late = [(at, action) for at, action in self.late if at > self.now()]
        for action in due:
            action()

    def _do(self, action: object, torn: object = None) -> None:
        fault = self.armed.pop(0) if self.armed else ""
        if fault == "lost":
            raise ConnectionLostError("lost before it was done")
        if fault == "late":
            self.late.append((self.now() + self.delay, action))
            raise ConnectionLostError("on its way")
        if fault.endswith("torn") and torn is not None:
            torn()
            if fault == "torn":
                raise UploadError("disk full")
            return
        if fault == "refused":
            raise UploadError("refused")
        action()
        if fault == "done but lost":
            raise ConnectionLostError("done, the answer was lost")

    def set_ready(self, value: bool) -> None:
        self._do(lambda: MemoryTransport.set_ready(self, value))

    def write_file(self, name: str, data: bytes) -> None:
        self._do(
            lambda: MemoryTransport.write_file(self, name, data),
            torn=lambda: MemoryTransport.write_file(self, name, data[: len(data) // 2]),
        )

    def remove_file(self, name: str) -> None:
        self._do(lambda: MemoryTransport.remove_file(self, name))

    def _ask(self, question: object) -> object:
        fault = self.armed.pop(0) if self.armed else ""
        if fault == "lost":
            raise ConnectionLostError("no answer")
        return question()

    def read_file(self, name: str) -> bytes:
        return self._ask(lambda: MemoryTransport.read_file(self, name))

    def read_ready(self) -> bool:
        return self._ask(lambda: MemoryTransport.read_ready(self))

    def read_signal(self, name: str) -> bool:
        return self._ask(lambda: MemoryTransport.read_signal(self, name))


class Histories(RuleBasedStateMachine):
    """The robot here believes ready: it mills whatever file it finds, unless its bytes are incomplete."""

    def __init__(self) -> None:
        super().__init__()
        self.time = 0.0
        self.placement = 0
        self.run = 0
        self.pictures: list[tuple[int, int]] = []
        self.link = FailingLink(lambda: self.time)
        self.start()

    def start(self) -> None:
        self.handshake = Handshake(self.link, lambda: self.time, LIMITS)
        self.handshake.on_start()
        self.pictures = []

    # Robot and operator

    @precondition(lambda self: not self.link.signal(signals.REQUEST) and not self.link.signal(signals.READY))
    @rule()
    def clamp_a_door_and_request(self) -> None:
        self.placement += 1
        self.link.set_signal(signals.FAULT, False)
        self.link.set_signal(signals.REQUEST, True)

    @rule()
    def withdraw(self) -> None:
        self.link.set_signal(signals.REQUEST, False)

    @precondition(lambda self: self.link.signal(signals.REQUEST) and self.link.signal(signals.READY))
    @rule()
    def read_and_mill(self) -> None:
        self.link.set_signal(signals.REQUEST, False)

    # The PC

    @rule(count=st.integers(1, 6))
    def step(self, count: int) -> None:
        for _ in range(count):
            self.handshake.step()

    @rule(seconds=st.sampled_from([0.01, 0.1, 0.3, 1.0, 2.5]))
    def pass_time(self, seconds: float) -> None:
        self.time += seconds
        self.link.arrive()

    @precondition(lambda self: self.handshake.snapshot.accepts_submission)
    @rule()
    def take_picture(self) -> None:
        self.pictures.append((self.placement, self.handshake.snapshot.request_number))

    @precondition(lambda self: self.pictures)
    @rule(data=st.data())
    def submit(self, data: st.DataObject) -> None:
        placement, number = data.draw(st.sampled_from(self.pictures))
        self.run += 1
        try:
            self.handshake.submit(f"run-{self.run}", "door", render(placement, self.run), number)
        except LinkError:
            return

    @rule(faults=st.lists(st.sampled_from(["", "", "", *FAULTS]), max_size=8), stale=st.booleans())
    def answer(self, faults: list[str], stale: bool) -> None:
        """A whole turn of the PC in one go, with faults on the operations after the submission."""
        if not self.link.signal(signals.REQUEST) and not self.link.signal(signals.READY):
            self.clamp_a_door_and_request()
        for _ in range(40):
            self.handshake.step()
            if self.handshake.snapshot.accepts_submission:
                break
            self.pass_time(0.1)
        if not self.handshake.snapshot.accepts_submission:
            return
        if not (stale and self.pictures):
            self.take_picture()
        placement, number = self.pictures[0 if stale else -1]
        self.run += 1
        try:
            self.handshake.submit(f"run-{self.run}", "door", render(placement, self.run), number)
        except LinkError:
            return
        self.link.armed = list(faults)
        self.handshake.step()

    @rule()
    def abort(self) -> None:
        self.handshake.abort("operator")

    @rule()
    def kill_and_restart(self) -> None:
        self.link.armed.clear()
        self.start()

    @rule(faults=st.lists(st.sampled_from(["", *FAULTS]), min_size=1, max_size=12))
    def arm(self, faults: list[str]) -> None:
        self.link.armed = list(faults)

    @invariant()
    def ready_announces_the_right_file(self) -> None:
        if not (self.link.signal(signals.READY) and self.link.signal(signals.REQUEST)):
            return
        data = self.link._files.get(signals.TARGET_FILE)
        if data is None:
            # An order to raise that was lost on its way may arrive late; by then there is nothing to read.
            assert self.handshake.snapshot.state is State.CLEARING, "ready without a file"
            return
        assert complete(data), "incomplete file announced"
        assert data.startswith(b"placement=%d;" % self.placement), "file of another clamping announced"

    @invariant()
    def cleared_states_are_cleared(self) -> None:
        if self.handshake.snapshot.state in CLEARED - {State.REQUESTED}:
            assert not self.link.signal(signals.READY)

    def teardown(self) -> None:
        """Once the link works again the next door is served: safety is not bought with a dead stop."""
        self.link.armed.clear()
        self.link.set_signal(signals.REQUEST, False)
        for _ in range(200):
            self.time += 0.1
            self.link.arrive()
            self.handshake.step()
        assert not self.link.signal(signals.READY)
        self.placement += 1
        self.link.set_signal(signals.REQUEST, True)
        self.handshake.step()
        self.handshake.step()
        self.handshake.submit("last", "door", render(self.placement, 0))
        self.handshake.step()
        assert self.link.signal(signals.READY)
        self.ready_announces_the_right_file()


TestHistories = Histories.TestCase
TestHistories.settings = settings(
    max_examples=300,
    stateful_step_count=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
)
