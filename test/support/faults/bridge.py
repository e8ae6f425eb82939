"""The PC's side of a run as a process: the handshake under test, and a planner that feeds it."""

from __future__ import annotations

import logging
import os
import random
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.handshake.loop import HandshakeLoop
from doormill_ros.abb.handshake.sharing import SharedHandshake
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeTimeouts
from doormill_ros.abb.link_errors import LinkError, UploadError
from doormill_ros.abb.signals import ORDER_FILE, READY, READY_NUMBER, REQUEST_FILE
from doormill_ros.abb.target_file.target_file import check_handover
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transports.rws import connect_rws1, connect_rws2
from doormill_ros.abb.transports.rws_http import LinkTimeouts
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from support.faults import small_disk
from support.faults.scenario import Scenario
from support.faults.world import DOORS, World, digest, make_file

TOTAL = 0.5
_FAIL_TIME = 1.5
#: The robot reads and mills in its interpreter, on a machine that is shared.
_LIMITS = HandshakeTimeouts(submission=4.0, acknowledge=20.0, milling=30.0, link_loss=0.3, watch=0.1)
_OPERATIONS = (
    "read_request",
    "set_ready",
    "read_ready",
    "read_signal",
    "read_number",
    "write_number",
    "write_file",
    "read_file",
    "remove_file",
)


class Meddler:
    """Passes operations on to the real transport, except where the scenario wants otherwise."""

    def __init__(self, inner: Transport, world: World, scenario: Scenario, armed: bool) -> None:
        self._inner = inner
        self._world = world
        self._scenario = scenario
        self._armed = armed
        self._count = 0
        self._failed = False
        self._fail_until = time.monotonic() + _FAIL_TIME
        self._chance = random.Random(f"meddler/{scenario.seed}/{os.getpid()}")
        self.in_doubt_time = inner.in_doubt_time
        self.wait, self.wake, self.close = inner.wait, inner.wake, inner.close
        for name in _OPERATIONS:
            setattr(self, name, lambda *a, name=name: self._do(name, *a))

    def _do(self, name: str, *arguments: Any) -> Any:
        kind, options = self._scenario.kind, self._scenario.options
        operation = getattr(self._inner, name)
        if not self._armed:
            return operation(*arguments)
        if name != "read_request":
            self._count += 1
        hit = self._count == int(options["operation"]) and name != "read_request"
        if hit and "at an operation" in kind:
            if self._chance.random() < 0.5:
                operation(*arguments)
            self._die()
        if name in ("write_file", "remove_file") and "late" in kind and self._chance.random() < 0.5:
            self._deliver_late(name, *arguments)
        if name == "write_file" and self._chance.random() < 0.5:
            self._tear(kind, *arguments)
            if kind.startswith("torn write"):
                return None
        if name == "write_file" and kind == "full disk":
            return small_disk.write_on(self._world, operation, *arguments)
        failing = time.monotonic() < self._fail_until or not self._failed
        if kind == "operations fail at random" and failing and self._chance.random() < options["probability"]:
            self._failed = True
            self._world.log("faults", what=f"{name} fails")
            if self._chance.random() < 0.5:
                operation(*arguments)
            raise UploadError(f"{name} fails on purpose")
        return operation(*arguments)

    def _deliver_late(self, name: str, file: str, data: bytes = b"") -> None:
        """Let the operation happen once more, some time later, as a controller may that sat on a request."""
        path = self._world.home / file
        if name == "remove_file" and file == ORDER_FILE and "late removal" in self._scenario.kind:
            again: Callable[[], object] = lambda: path.unlink(missing_ok=True)  # noqa: E731
        elif name == "write_file" and file != ORDER_FILE and "late upload" in self._scenario.kind:
            again = lambda: path.write_bytes(data)  # noqa: E731
        else:
            return
        self._world.log("faults", what=f"late {name} of {file}")
        later = threading.Timer(self._chance.uniform(0.02, 1.2), again)
        later.daemon = True
        later.start()

    def _tear(self, kind: str, name: str, data: bytes) -> None:
        """Write part of the file in place, as a share without atomic replacement may."""
        if "mid-write" in kind or kind.startswith("torn write"):
            self._armed = "mid-write" in kind or self._chance.random() < 0.5
            self._world.log("faults", what=f"torn write of {name}")
            (self._world.home / name).write_bytes(data[: self._chance.randrange(len(data))])
        if "mid-write" in kind:
            self._die()
        if kind == "torn write, reported":
            raise UploadError("disk full on purpose")

    def _die(self) -> None:
        self._world.log("faults", what="kill -9 of the bridge by itself")
        os.kill(os.getpid(), signal.SIGKILL)


class Bridge:
    """One life of the bridge process."""

    def __init__(self, world: World, scenario: Scenario, life: int, link: dict[str, str]) -> None:
        self.world = world
        self.scenario = scenario
        self.armed = life < scenario.faults
        self.life = life
        self.chance = random.Random(f"bridge/{scenario.seed}/{life}")
        if "clock step" in scenario.kind:
            self._struck()
            self._step_the_wall_clock()
        transport = Meddler(open_link(world, scenario, link), world, scenario, self.armed)
        check = None if scenario.sabotage == "verify" else check_handover
        self.handshake = SharedHandshake(transport, timeouts=_LIMITS, check=check, on_change=self._changed)
        sabotage(self.handshake, scenario.sabotage)
        self.runs = 0
        self.old: tuple[int, str, int] | None = None

    def run(self) -> None:
        """Answer requests until killed."""
        loop = HandshakeLoop(self.handshake)
        loop.start()
        answered = -1
        while loop.alive:
            now = self.handshake.snapshot
            if now.accepts_submission and (now.request_number != answered or self.chance.random() < 0.02):
                answered = now.request_number
                self._answer(now.request_number)
            time.sleep(0.01)
        self.world.log("ended", what=f"bridge: {loop.failure!r}")

    def _struck(self) -> None:
        self.world.log("faults", what=self.scenario.kind)

    def _answer(self, number: int) -> None:
        kind = self.scenario.kind
        placement, door_id = self.world.door()
        time.sleep(self.chance.choice([0.0, 0.01, 0.04]))
        if kind == "late file" and self.armed and self.chance.random() < 0.5:
            self._struck()
            time.sleep(self.chance.uniform(0.1, 1.2))
        if kind == "late file" and self.old is not None and self.chance.random() < 0.3:
            self._struck()
            self._submit(*self.old)  # what an earlier picture gave, with that picture's request
        self.old = (placement, door_id, number)
        if kind == "file of another door" and self.armed and self.chance.random() < 0.5:
            self._struck()
            other = DOORS[1 - DOORS.index(door_id)]
            self._submit(placement, door_id, number, file_door=other)
            return
        if kind == "door mixed up upstream" and self.armed and self.chance.random() < 0.5:
            self._struck()
            other = DOORS[1 - DOORS.index(door_id)]
            self._submit(placement, other, number)
            return
        if kind == "two files at once" and self.armed:
            self._struck()
            rival = threading.Thread(target=self._submit, args=(placement, door_id, number))
            rival.start()
            self._submit(placement, door_id, number)
            rival.join()
            return
        if kind == "ready raised by somebody else" and self.armed and self.chance.random() < 0.5:
            number = (self.world.home / REQUEST_FILE).read_bytes().strip()
            (self.world.home / "io" / READY_NUMBER).write_bytes(number)
            (self.world.home / "io" / READY).write_bytes(b"1")
            self._struck()
        self._submit(placement, door_id, number)

    def _submit(self, placement: int, door_id: str, number: int, file_door: str = "") -> None:
        self.runs += 1
        run_id = f"{os.getpid()}-{self.runs}-{threading.get_ident() % 1000}"
        data = make_file(placement, file_door or door_id, run_id)
        self.world.log(
            "planned", run=run_id, placement=placement, door=file_door or door_id, sha=digest(data)
        )
        try:
            self.handshake.submit(run_id, door_id, data, number)
        except AbbError as error:
            self.world.log("submissions", refused=type(error).__name__)

    def _changed(self, snapshot: HandshakeSnapshot) -> None:
        state, reason, run = snapshot.state.value, snapshot.reason, snapshot.run_id
        self.world.log("bridge", life=self.life, state=state, reason=reason, run=run)
        if (
            self.armed
            and self.scenario.kind == f"kill -9 in {snapshot.state.value}"
            and self.chance.random() < 0.7
        ):
            self.world.log("faults", what=self.scenario.kind)
            os.kill(os.getpid(), signal.SIGKILL)

    def _step_the_wall_clock(self) -> None:
        real, chance = time.time, self.chance
        time.time = lambda: real() + chance.choice([-1e6, -3600.0, 0.0, 3600.0, 1e6])


def open_link(world: World, scenario: Scenario, link: dict[str, str]) -> Transport:
    """The real transport of the scenario, waiting for what it needs."""
    while True:
        try:
            if scenario.transport == "folder":
                return SimulatedFolderTransport(world.home, timeout=TOTAL)
            credentials = Credentials("Default User", "robotics", "4711")
            timeouts = LinkTimeouts(connect=0.3, read=0.25, write=0.25, total=TOTAL)
            if scenario.transport == "rws1":
                return connect_rws1(link["url"], credentials, timeouts=timeouts, poll_interval=0.05)
            certificate = Path(link["certificate"])
            return connect_rws2(
                link["url"], credentials, certificate=certificate, timeouts=timeouts, poll_interval=0.05
            )
        except LinkError:
            time.sleep(0.05)


def sabotage(handshake: SharedHandshake, part: str) -> None:
    """Leave a part of the handshake out, for the test that the judge can see."""
    if part == "verify":
        handshake._access.verify = lambda submission: None
    elif part == "clear":
        handshake._access.clear = lambda: None
    elif part == "mark":
        handshake._access._require_mark = lambda mark: None


def bridge_process(world: World, scenario: Scenario, life: int, link: dict[str, str]) -> None:
    """Entry of the process."""
    logging.disable(logging.CRITICAL)
    Bridge(world, scenario, life, link).run()
