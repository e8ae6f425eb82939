"""The controller of a recorded run, played to the bridge: when it asked, that it read the file, how it ended."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.files import write_atomically
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.units import ns_to_s

POLL = 0.005  # s
ENDS = {HandshakeState.DONE.value: signals.DONE, HandshakeState.FAILED.value: signals.FAULT}


@dataclass(frozen=True)
class RecordedEvent:
    """A signal that the controller set.

    Attributes:
        signal: One of `doormill_ros.abb.signals`.
        value: High or low.
        delay: Time since the event before [s]; since the ready signal rose when it waited for that.
        ready: Level of the ready signal that it waits for: high to acknowledge a file, low to end milling
            it; None for either.
    """

    signal: str
    value: bool
    delay: float
    ready: bool | None = None


def controller_events(
    begun_ns: int, requests: Sequence[tuple[int, bool]], states: Sequence[tuple[int, str]]
) -> list[RecordedEvent]:
    """What the controller did in a run until milling ended, from what the bridge published of it.

    Args:
        begun_ns: When the run's recipe was recorded [ns].
        requests: The request as abb/status tells it, with the time of recording [ns].
        states: State of abb/status with the time of recording [ns].
    """
    # What is told in one message: the state comes first, as a controller may answer the ready signal before
    # the bridge has told that it is high.
    course = [(t, 0, v) for t, v in states] + [(t, 1, v) for t, v in requests]
    events: list[RecordedEvent] = []
    high, milling, before_ns = False, False, begun_ns
    ready_ns: int | None = None
    for stamp_ns, is_request, value in sorted(course):
        if not is_request:
            ready_ns = stamp_ns if value == HandshakeState.READY.value else ready_ns
            milling = milling or value == HandshakeState.MILLING.value
            if not (milling and value in ENDS):
                continue
            events.append(RecordedEvent(ENDS[value], True, ns_to_s(max(0, stamp_ns - before_ns)), False))
            break
        if value == high:
            continue
        high = bool(value)
        since_ns = before_ns
        ready: bool | None = None
        if not high and ready_ns is not None:  # it answers the ready signal
            since_ns, ready, ready_ns = ready_ns, True, None
        events.append(RecordedEvent(signals.REQUEST, high, ns_to_s(max(0, stamp_ns - since_ns)), ready))
        before_ns = stamp_ns
    return events


def with_end(events: list[RecordedEvent], signal: str) -> list[RecordedEvent]:
    """The events, ended by `signal` when the recording stopped before the bridge told of the end."""
    if events and events[-1].signal in ENDS.values():
        return events
    return [*events, RecordedEvent(signal, True, 0.0, False)]


class RecordedController:
    """Plays events on the signals in a folder, from a thread; a context manager.

    Args:
        home: The controller's HOME, as the bridge's simulated folder.
        events: What to play.
        rate: Times the recorded speed; infinite for without pauses.
        reason: What the robot program wrote about its fault; empty when it wrote nothing.
    """

    def __init__(self, home: Path, events: Sequence[RecordedEvent], rate: float, reason: str = "") -> None:
        self._home = home
        self._io = FolderIo(home)
        self._reason = reason
        self._number = 0
        self._events = events
        self._rate = rate
        self._begun = threading.Event()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._play, name="recorded controller", daemon=True)

    def begin(self) -> None:
        """The run's recipe is there: its times count from now."""
        self._begun.set()

    def __enter__(self) -> RecordedController:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._begun.set()
        self._thread.join()

    def _play(self) -> None:
        self._begun.wait()
        for event in self._events:
            while event.ready not in (None, bool(self._io.read(signals.READY))):
                if self._stopped.wait(POLL):
                    return
            if self._stopped.wait(event.delay / self._rate):
                return
            self._write_files(event)
            self._io.write(event.signal, int(event.value))

    def _write_files(self, event: RecordedEvent) -> None:
        """What the robot program writes before it sets the signal: its request's number, the run it took, its fault."""
        if event.signal == signals.REQUEST and event.value:
            self._number += 1
            write_atomically(self._home / signals.REQUEST_FILE, f"{self._number}\n")
        elif event.signal == signals.REQUEST and event.ready:
            order = self._home / signals.ORDER_FILE
            if order.exists():
                write_atomically(self._home / signals.ACCEPTED_FILE, order.read_bytes())
        elif event.signal == signals.FAULT and self._reason:
            write_atomically(self._home / signals.REFUSED_FILE, f"{self._number}\n{self._reason}\n")
