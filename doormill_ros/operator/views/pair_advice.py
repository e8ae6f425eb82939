"""What the operator of two robots should do now: as for one, and it names the robot that it is about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from doormill_ros.operator.views.advice import (
    CLEARING,
    CLOSING,
    WAIT,
    Advice,
    fault_step,
    stopped_step,
    unknown_step,
)
from doormill_ros.operator.views.robot_view import HANDING
from doormill_ros.operator.views.situation import MAY_MOVE, MOVING

#: Sentences about one of the robots.
_OF = {
    "silent_of": (
        "fault",
        "Nothing is known of robot {robot}: /robot{robot}/abb_bridge does not answer. Stay out; restart it.",
    ),
    "stay_out_of": ("danger", "Stay out of the cell. Robot {robot} mills the door."),
    "about_to_move_of": ("danger", "Stay out of the cell. Robot {robot} is about to move."),
    "clamp_of": (
        "act",
        "Clamp the door and start the program of robot {robot}; its controller has not asked for targets yet.",
    ),
    "next_door_of": ("act", "Clamp the next door, then start the program of robot {robot}."),
    "half_milled": (
        "act",
        "The door is half milled: robot {robot} has milled its share, then the run was given up. See that both robots "
        "stand still and look at the door before it is used.",
    ),
}
#: Sentences about both.
_BOTH = {
    "silent_both": (
        "fault",
        "Nothing is known of the robots: neither /robot1/abb_bridge nor /robot2/abb_bridge answers. Stay out; restart "
        "them.",
    ),
    "clamp_both": (
        "act",
        "Clamp the door and start the programs of both robots; their controllers have not asked for targets yet.",
    ),
    "next_door_both": ("act", "Clamp the next door, then start the programs of both robots."),
    "start_both": ("act", "The controllers of both robots are ready for a door. Start milling it."),
    "done_both": (
        "act",
        "The door is milled. Take it out when both robots have stopped and clamp the next one.",
    ),
    "failed_both": (
        "act",
        "The last run came to nothing. See that both robots stand still, put right what is said below, start again.",
    ),
    "not_milled_both": (
        "act",
        "The door was not milled. See that both robots stand still, put right what is said below, start again.",
    ),
    "spoiled_both": (
        "act",
        "The door was milled out of tolerance. Put it aside when both robots have stopped, and mill no other before it "
        "is known why.",
    ),
    "milled_after_all_both": (
        "act",
        "The run was given up, but the robots milled on to the end. See that both stand still and look at the door "
        "before it is used.",
    ),
}
_WAITING = (*HANDING, "requested", "turn")


def pair_step(
    does: Mapping[int, str],
    run_in_hand: bool,
    refused: bool,
    faults: Mapping[str, str],
    spoiled: bool = False,
    milled: Sequence[int] = (),
    lacking: bool = True,
    stopped: str = "",
) -> Advice:
    """What to do now.

    Args:
        does: What each robot does, by number; see `robot_view.DOES`.
        run_in_hand: A door is being milled.
        refused: The door in hand or the last one was refused.
        faults: What nodes in error say of themselves, by node.
        spoiled: The last door was milled out of tolerance.
        milled: Robots that milled their share of the last run to the end.
        lacking: Another one had something to mill in it and did not.
        stopped: Why no door is milled before somebody decides; empty when they are.
    """
    doing = list(does.values())
    if "silent" in doing:
        return _of_or_both("silent", does, "silent")
    for what in (*MOVING, MAY_MOVE):
        if what in doing:
            return _of("stay_out_of" if what == "milling" else "about_to_move_of", does, what)
    if run_in_hand and "share" in doing and (turn := [what for what in doing if what in ("turn", *HANDING)]):
        return _of("about_to_move_of", does, turn[0])
    if faults:
        return fault_step(faults)
    if run_in_hand:
        return _in_hand(does, doing)
    if stopped:
        return stopped_step(stopped)
    if refused and spoiled:
        return _both("spoiled_both")
    if refused and milled and lacking:
        return _named("half_milled", milled[0])
    if refused:
        return _both("milled_after_all_both" if milled else "not_milled_both")
    return _between_doors(does, doing)


def _in_hand(does: Mapping[int, str], doing: Sequence[str]) -> Advice:
    if "failed" in doing:
        return CLOSING
    if "clearing" in doing:
        return CLEARING
    if "asks_not" in doing:
        return _of_or_both("clamp", does, "asks_not")
    if any(what in _WAITING for what in doing):
        return WAIT
    strange = [what for what in doing if what not in ("share", "unneeded")]
    return unknown_step(strange[0]) if strange else CLOSING


def _between_doors(does: Mapping[int, str], doing: Sequence[str]) -> Advice:
    if "clearing" in doing:
        return CLEARING
    if any(what in HANDING for what in doing):
        return WAIT
    if "failed" in doing:
        return _both("failed_both")
    if "share" in doing:
        return _both("done_both")
    if "idle" in doing:
        return _of_or_both("next_door", does, "idle")
    strange = [what for what in doing if what != "requested"]
    return unknown_step(strange[0]) if strange else _both("start_both")


def _of_or_both(key: str, does: Mapping[int, str], what: str) -> Advice:
    every = all(own == what for own in does.values())
    return _both(f"{key}_both") if every else _of(f"{key}_of", does, what)


def _of(key: str, does: Mapping[int, str], what: str) -> Advice:
    return _named(key, next(number for number, own in does.items() if own == what))


def _named(key: str, number: int) -> Advice:
    urgency, text = _OF[key]
    return Advice(urgency, key, text.format(robot=number), {"robot": str(number)})


def _both(key: str) -> Advice:
    urgency, text = _BOTH[key]
    return Advice(urgency, key, text)
