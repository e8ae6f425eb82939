"""States, time limits and what an observer sees of the handshake."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum


class HandshakeState(str, Enum):
    """Where the handshake is; READY is the only state in which the ready signal is meant to be high."""

    CLEARING = "clearing"
    """Ready signal and target file are being cleared, or the controller cannot be reached."""
    IDLE = "idle"
    """Cleared; the controller asks for nothing."""
    REQUESTED = "requested"
    """Cleared; the controller asks for a file and none is there yet."""
    WRITING = "writing"
    """The file is on its way to the controller."""
    VERIFYING = "verifying"
    """The file is read back and compared."""
    RAISING = "raising"
    """The ready signal is set and read back."""
    READY = "ready"
    """Ready is high; the controller reads the file."""
    ACKNOWLEDGED = "acknowledged"
    """The request fell; ready is being lowered and the file removed."""
    MILLING = "milling"
    """Cleared; the controller took the file and has not reported the end."""
    DONE = "done"
    """Cleared; the controller reported the end of milling."""
    FAILED = "failed"
    """Cleared; the last run came to nothing, the reason says why."""


#: States in which the ready signal was read back low and the target file is known to be gone.
CLEARED = frozenset(
    {
        HandshakeState.IDLE,
        HandshakeState.REQUESTED,
        HandshakeState.MILLING,
        HandshakeState.DONE,
        HandshakeState.FAILED,
    }
)


@dataclass(frozen=True)
class HandshakeTimeouts:
    """Limits of the waits, all on a monotonic clock [s].

    Attributes:
        submission: From the request to the submitted file.
        acknowledge: From ready high to the request's fall.
        milling: From the acknowledgement to the done signal.
        link_loss: How long the request may be unreadable while ready is high.
        watch: How often the ready signal is checked to be low while nothing happens.
        retry_first: First pause between attempts to clear.
        retry_last: Longest pause between attempts to clear.
    """

    submission: float = 60.0
    acknowledge: float = 30.0
    milling: float = 3600.0
    link_loss: float = 1.0
    watch: float = 0.5
    retry_first: float = 0.05
    retry_last: float = 1.0


@dataclass(frozen=True)
class RunOutcome:
    """How a submitted run ended.

    Attributes:
        run_id: The run.
        door_id: Its door.
        handed_over: The controller read the file and did not refuse it.
        error_code: Code of the `LinkError` leaf, 0 when handed over.
        reason: One sentence.
        milled: Of a run that was handed over: whether the robot milled it to its end, None while it mills.
    """

    run_id: str
    door_id: str
    handed_over: bool
    error_code: int
    reason: str
    milled: bool | None = None


@dataclass(frozen=True)
class HandshakeSnapshot:
    """The handshake at one instant, free to pass between threads.

    Attributes:
        state: The state.
        reason: Why it is in this state, one sentence.
        since: When the state began, on the handshake's monotonic clock [s].
        error_code: Code of the error that led here, 0 when none did.
        request: The request signal when it was last read.
        request_number: Requests seen since the start; a submission belongs to one of them.
        run_id: Run handed over, or being so, for the present request; empty before there is one.
        door_id: Its door.
        outcome: End of the last run that ended.
        times: When each state was last entered within the present request, by state value [s].
    """

    state: HandshakeState
    reason: str
    since: float
    error_code: int = 0
    request: bool = False
    request_number: int = 0
    run_id: str = ""
    door_id: str = ""
    outcome: RunOutcome | None = None
    times: dict[str, float] = field(default_factory=dict)

    @property
    def accepts_submission(self) -> bool:
        """True when `Handshake.submit` would take a file now."""
        waiting = self.state is HandshakeState.FAILED and self.request
        return waiting or self.state is HandshakeState.REQUESTED
