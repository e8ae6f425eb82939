"""Two robots at one door: the sentence that is true of both, the next step, and what came of each one's share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from doormill_ros.operator.views.robot_view import DOES, HANDING, RobotView
from doormill_ros.operator.views.situation import MAY_MOVE, MOVING, Situation

ROBOTS = (1, 2)
#: Whose state stands for the cell's, the first that a robot is in: moving before all, then what is waited for.
_RANK = (
    *MOVING,
    MAY_MOVE,
    "failed",
    "clearing",
    "asks_not",
    *HANDING,
    "turn",
    "share",
    "idle",
    "requested",
    "unneeded",
    "silent",
)
#: What a robot does as a state of the handshake, where it is not one.
_STATES = {
    MAY_MOVE: "clearing",
    "asks_not": "idle",
    "turn": "requested",
    "share": "done",
    "unneeded": "idle",
    "silent": "",
}


@dataclass(frozen=True)
class PairView:
    """Both robots.

    Attributes:
        robots: The first and the second.
        needed: Numbers of those that have something to mill, by run: of the door drawn.
        run_id: Run of that door.
    """

    robots: tuple[RobotView, RobotView] = (RobotView(1), RobotView(2))
    needed: tuple[int, ...] = ROBOTS
    run_id: str = ""

    def with_robot(self, robot: RobotView) -> PairView:
        """One of them changed."""
        first, second = (robot if robot.number == own.number else own for own in self.robots)
        return replace(self, robots=(first, second))

    def of_run(self, run_id: str, needed: tuple[int, ...]) -> PairView:
        """A run's recipe tells who has something to mill."""
        return replace(self, run_id=run_id, needed=needed)

    def workers(self, run_id: str) -> tuple[int, ...]:
        """Who has something to mill in a run; both where nobody knows."""
        return self.needed if run_id == self.run_id else ROBOTS

    def milled(self, run_id: str) -> tuple[int, ...]:
        """Who milled the share of a run to the end."""
        return tuple(robot.number for robot in self.robots if run_id and robot.milled_run == run_id)

    def does(self, run_id: str, last_run: str) -> dict[int, str]:
        """What each of them does, by number; see `RobotView.does`."""
        workers = self.workers(run_id)
        pairs = zip(self.robots, reversed(self.robots), strict=True)
        return {own.number: own.does(run_id, last_run, own.number in workers, other) for own, other in pairs}

    def situation(self, run_id: str, door_id: str, last_run: str) -> tuple[Situation, RobotView]:
        """State and sentence, and the robot whose state that is."""
        does = self.does(run_id, last_run)
        lead = min(self.robots, key=lambda robot: _rank(does[robot.number]))
        parts = [said(number, what) for number, what in does.items()]
        parts += [
            f"robot {robot.number}: {robot.reason}"
            for robot in self.robots
            if robot.reason and does[robot.number] in ("failed", "clearing", MAY_MOVE)
        ]
        key = does[lead.number]
        state = _STATES.get(key, key)
        return Situation(state, "; ".join(parts), state == lead.state, key, door_id), lead

    def shares(self, run_id: str, success: bool | None) -> dict[int, str]:
        """What came of each one's share of a run; see `RobotView.share`."""
        return {robot.number: robot.share(run_id, success) for robot in self.robots}

    def document(self, does: Mapping[int, str]) -> list[dict[str, Any]]:
        """JSON-able content, of each robot."""
        return [
            {
                "robot": robot.number,
                "present": robot.present,
                "state": robot.state if robot.present else "",
                "does": does[robot.number],
                "reason": robot.reason,
                "code": robot.code,
            }
            for robot in self.robots
        ]


def said(number: int, does: str) -> str:
    """What a robot does, in English."""
    return DOES[does].format(robot=number) if does in DOES else f"robot {number} is in the state {does!r}"


def _rank(does: str) -> int:
    return _RANK.index(does) if does in _RANK else 0
