"""What the operator should do now, from what the cell is doing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from doormill_ros.operator.views.situation import MAY_MOVE


@dataclass(frozen=True)
class Advice:
    """A sentence for the operator.

    Attributes:
        urgency: wait, act, danger or fault; colours it.
        key: Of the sentence in the page's texts, behind "step.".
        text: The sentence in English.
        values: What stands in it, by name.
    """

    urgency: str
    key: str
    text: str
    values: Mapping[str, str] = field(default_factory=dict)


WAIT = Advice("wait", "wait", "Wait. The cell is measuring the door and working out the robot's path.")
_STAY_OUT = Advice("danger", "stay_out", "Stay out of the cell. The robot mills the door.")
_ABOUT_TO_MOVE = Advice("danger", "about_to_move", "Stay out of the cell. The robot is about to move.")
CLOSING = Advice("wait", "closing", "Wait. The run is being closed.")
LONGEST_NAME = 30  # characters of a door's id in a sentence
#: Sentences that name the door that ended last.
_OF_DOOR = {
    "spoiled": "The door{door} was milled out of tolerance. Put it aside when the robot has stopped, and mill no other "
    "before it is known why.",
    "milled_after_all": "The run of the door{door} was given up, but the robot milled on to the end. See that it "
    "stands still and look at the door before it is used.",
    "not_milled": "The door{door} was not milled. See that the robot stands still, put right what is said below, start "
    "again.",
    "done": "The door{door} is milled. Take it out when the robot has stopped and clamp the next one.",
}
CLEARING = Advice(
    "wait", "clearing", "Wait until the link to the controller is clear. If this lasts, see the state below."
)

#: By state of the handshake, for a run in hand; see doormill_ros.abb.handshake.state.
_WITH_RUN = {
    "clearing": CLEARING,
    "idle": Advice(
        "act", "clamp", "Clamp the door and start the controller's program; it has not asked for targets yet."
    ),
    "requested": WAIT,
    "writing": WAIT,
    "verifying": WAIT,
    "raising": WAIT,
    "ready": _ABOUT_TO_MOVE,
    "acknowledged": _ABOUT_TO_MOVE,
    MAY_MOVE: _ABOUT_TO_MOVE,
    "milling": _STAY_OUT,
    "done": CLOSING,
    "failed": CLOSING,
}
_WITHOUT_RUN = {
    "clearing": CLEARING,
    "idle": Advice("act", "next_door", "Clamp the next door, then start the controller's program."),
    "requested": Advice("act", "start", "The controller is ready for a door. Start milling it."),
    "failed": Advice(
        "act",
        "failed",
        "The last run came to nothing. See that the robot stands still, put right what is said below, start again.",
    ),
}


def next_step(
    bridge_present: bool,
    state: str,
    run_in_hand: bool,
    refusal: str,
    faults: Mapping[str, str],
    spoiled: bool = False,
    milled: bool = False,
    stopped: str = "",
    door: str = "",
) -> Advice:
    """What to do now.

    Args:
        bridge_present: The ABB bridge gives signs of life.
        state: State of the handshake with the controller, or `MAY_MOVE`.
        run_in_hand: A door is being milled.
        refusal: Why the door in hand or the last one was refused.
        faults: What nodes in error say of themselves, by node.
        spoiled: The last door was milled out of tolerance.
        milled: The robot reported the end of milling of the last run, however that ended.
        stopped: Why no door is milled before somebody decides; empty when they are.
        door: The door that ended last, empty where its name is not known.
    """
    if not bridge_present or not state:
        return Advice(
            "fault",
            "silent",
            "Nothing is known of the robot: /abb_bridge does not answer. Stay out; restart it.",
        )
    # The robot may move, whatever else is wrong.
    in_motion = (_WITH_RUN if run_in_hand else {**_WITH_RUN, **_WITHOUT_RUN}).get(state)
    if in_motion is not None and in_motion.urgency == "danger":
        return in_motion
    if faults:
        return fault_step(faults)
    if stopped and not run_in_hand:
        return stopped_step(stopped)
    if refusal and not run_in_hand:
        # A run can also end while the robot moves: canceled, or given up after its time limit.
        return _of_door("spoiled" if spoiled else "milled_after_all" if milled else "not_milled", door)
    if state == "done" and not run_in_hand:
        return _of_door("done", door)
    return in_motion or unknown_step(state)


def fault_step(faults: Mapping[str, str]) -> Advice:
    """Nodes are in error: what the first of them says of itself."""
    node, message = next(iter(faults.items()))
    return _with(
        "fault",
        "fault",
        "Put right what {node} reports, or call maintenance: {message}",
        node=node,
        message=message,
    )


def stopped_step(message: str) -> Advice:
    """No door is milled before somebody decides, and why."""
    return _with("act", "stopped", "Mill no door before the engineer has decided: {message}", message=message)


def unknown_step(state: str) -> Advice:
    """The handshake is in a state that it does not have."""
    return _with(
        "fault",
        "unknown",
        "The controller link is in the unknown state {state}. Call maintenance.",
        state=repr(state),
    )


def _of_door(key: str, door: str) -> Advice:
    # With its blank, so that a door without a name leaves none, in every language. What to do has to fit a telephone.
    name = door if len(door) <= LONGEST_NAME else f"{door[: LONGEST_NAME - 1]}…"
    return _with("act", key, _OF_DOOR[key], door=f" {name}" if name else "")


def _with(urgency: str, key: str, text: str, **values: str) -> Advice:
    return Advice(urgency, key, text.format(**values), values)
