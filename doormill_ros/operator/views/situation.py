"""The handshake's state as it concerns the door that the page speaks of."""

from __future__ import annotations

from typing import NamedTuple

MOVING = ("milling", "acknowledged", "ready")  #: states in which a robot moves, or may at any moment
#: Of the sentence for a link that is cleared while the robot has its targets.
MAY_MOVE = "may_move"
_ENDS = {"done": "was milled", "failed": "came to nothing"}


def may_move_in(state: str, before: bool) -> bool:
    """Whether a robot may move in a state of its handshake; before: whether it might in the one before that.

    The bridge clears the link when the file is handed over and when the link breaks: the robot goes on meanwhile.
    """
    return state in MOVING or (state == "clearing" and before)


def told_in_run(told: str, in_hand: str, code: int) -> bool:
    """Whether a link that is cleared tells by itself that the robot may move: of the run in hand, and without an error.

    Whoever is started in between hears of that state alone.
    """
    return told == in_hand != "" and not code


class Situation(NamedTuple):
    """What the handshake's state means for one door.

    Attributes:
        state: State of the handshake.
        reason: Why it is in that state, one sentence in English.
        told: It is the controller's own state, not one that follows for a door behind another.
        key: Of the sentence in the page's texts, behind "situation."; the state itself where it is the controller's.
        door: The door that the sentence speaks of.
        before: The door before that, empty where its name is not known.
        ended: done or failed, how that ended; empty where the sentence does not speak of it.
    """

    state: str
    reason: str
    told: bool
    key: str
    door: str = ""
    before: str = ""
    ended: str = ""


def situation(
    state: str,
    reason: str,
    told: tuple[str, str],
    in_hand: tuple[str, str],
    last_run: str,
    request: bool,
    may_move: bool = False,
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
        may_move: The robot has its targets, or was about to read them, and has not come to an end since.
    """
    (told_run, told_door), (run_id, door_id) = told, in_hand
    own = Situation(state, reason, True, state)
    if state == "clearing" and may_move:
        return own._replace(key=MAY_MOVE)
    if state not in _ENDS:
        return own
    before = f"the door before{f', {told_door},' if told_door else ''} {_ENDS[state]}"
    doors = (door_id, told_door, state)
    if run_id:
        if run_id == told_run:
            return own
        if request:
            measured = f"door {door_id} is measured for the controller's request; {before}"
            return Situation("requested", measured, False, "measured", *doors)
        waits = f"door {door_id} waits for the controller to ask for targets; {before}"
        return Situation("idle", waits, False, "waits", *doors)
    if told_run and last_run not in ("", told_run):
        return Situation("idle", f"the controller asks for nothing; {before}", False, "nothing", *doors)
    return own
