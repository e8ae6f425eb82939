"""The handshake's state as it concerns the door that the page speaks of."""

from __future__ import annotations

from typing import NamedTuple

_ENDS = {"done": "was milled", "failed": "came to nothing"}


class Situation(NamedTuple):
    """State of the handshake and why it is in it, one sentence; `told`: the controller's own state, not another's."""

    state: str
    reason: str
    told: bool = True


def situation(
    state: str,
    reason: str,
    told: tuple[str, str],
    in_hand: tuple[str, str],
    last_run: str,
    request: bool,
) -> Situation:
    """State and reason for the door in hand, or for the last one.

    The handshake stays done or failed until the next request rises. When another run has begun by then, or has ended
    before it came so far, that state tells nothing of it: its door waits, or nothing is asked for.

    Args:
        state: State of the handshake.
        reason: Why it is in that state.
        told: Run and door of that state, empty when it is about none.
        in_hand: Run and door in hand, empty when there is none.
        last_run: Run that ended last, empty when none did.
        request: The controller asks for targets.
    """
    (told_run, told_door), (run_id, door_id) = told, in_hand
    if state not in _ENDS:
        return Situation(state, reason)
    before = f"the door before{f', {told_door},' if told_door else ''} {_ENDS[state]}"
    if run_id:
        if run_id == told_run:
            return Situation(state, reason)
        if request:
            return Situation(
                "requested", f"door {door_id} is measured for the controller's request; {before}", False
            )
        waits = f"door {door_id} waits for the controller to ask for targets"
        return Situation("idle", f"{waits}; {before}", False)
    if state == "done" and told_run and last_run not in ("", told_run):
        return Situation("idle", f"the controller asks for nothing; {before}", False)
    return Situation(state, reason)
