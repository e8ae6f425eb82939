"""What a handshake goes on with after an error, and what it says of it."""

from __future__ import annotations

from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.link_errors import LinkError, MillingTimeoutError


def state_after(state: State, error: LinkError) -> State:
    """The state that goes on once the controller is cleared: the one before, where the error ends nothing."""
    resting = state in (State.IDLE, State.DONE)
    milling_on = state is State.MILLING and not isinstance(error, MillingTimeoutError)
    waiting_on = state is State.REQUESTED and error.connection
    return state if resting or milling_on or waiting_on else State.FAILED


def may_be_taken(state: State) -> bool:
    """Whether the robot may have taken the file: it does between its last look at ready and the fall of its request."""
    return state in (State.READY, State.ACKNOWLEDGED)


def sentence(state: State, error: LinkError) -> str:
    """What went wrong, and what to look at."""
    if error.connection and may_be_taken(state):
        return f"{error.message}; the controller may have taken the file: look at the robot before you repeat"
    return error.message
