"""One of two robots as the page knows it, and what it does for the door that the page speaks of."""

from __future__ import annotations

from dataclasses import dataclass, replace

from doormill_ros.operator.views.situation import MAY_MOVE, MOVING, may_move_in, told_in_run

HANDING = ("raising", "verifying", "writing")  #: its targets are on their way
#: What a robot does, in English; the state of its handshake where nothing follows from the other robot or the door.
DOES = {
    "silent": "nothing is known of robot {robot}",
    "clearing": "the link to robot {robot} is being cleared",
    MAY_MOVE: "robot {robot} may move, and the link to it is being cleared",
    "idle": "the controller of robot {robot} asks for nothing",
    "asks_not": "the controller of robot {robot} has not asked for targets yet",
    "requested": "the controller of robot {robot} asks for targets",
    "turn": "robot {robot} waits for its turn",
    "unneeded": "robot {robot} has nothing to mill at this door",
    "writing": "the targets are being written to the controller of robot {robot}",
    "verifying": "the targets of robot {robot} are being read back and compared",
    "raising": "the controller of robot {robot} is being told that its targets are ready",
    "ready": "robot {robot} may read its targets",
    "acknowledged": "robot {robot} has read its targets",
    "milling": "robot {robot} mills",
    "share": "robot {robot} has milled its share",
    "failed": "the last run of robot {robot} came to nothing",
}


@dataclass(frozen=True)
class RobotView:
    """A robot and its bridge at one moment.

    Attributes:
        number: 1 or 2, as its namespace has it.
        present: Its bridge gives signs of life.
        state: State of its handshake, empty before it was heard of.
        reason: Why it is in that state.
        code: Code of the error that led there, 0 when none did.
        run_id: Run that the state is about, empty when about none.
        since: When it came into that state, by the steady clock [s]; None: not known.
        request: Its controller asks for targets.
        milled_run: The last run whose share it milled to the end.
        may_move: It has its targets, or was about to read them, and has not come to an end since.
    """

    number: int
    present: bool = False
    state: str = ""
    reason: str = ""
    code: int = 0
    run_id: str = ""
    since: float | None = None
    request: bool = False
    milled_run: str = ""
    may_move: bool = False

    def told(
        self, state: str, reason: str, run_id: str, request: bool, since: float | None, code: int
    ) -> RobotView:
        """Its handshake changed."""
        milled = run_id if state == "done" else self.milled_run
        may_move = may_move_in(state, self.may_move)
        return RobotView(self.number, True, state, reason, code, run_id, since, request, milled, may_move)

    def heard(self, present: bool) -> RobotView:
        """Its bridge was heard of lately, or not."""
        return replace(self, present=present)

    def does(self, run_id: str, last_run: str, needed: bool, other: RobotView) -> str:
        """What it does, a key of `DOES`; a state that nobody knows stays what it is.

        Args:
            run_id: Run in hand, empty when there is none.
            last_run: Run that ended last, empty when none did.
            needed: It has something to mill in the run in hand.
            other: The other robot.
        """
        if not (self.present and self.state):
            return "silent"
        if self.state == "clearing" and (self.may_move or told_in_run(self.run_id, run_id, self.code)):
            return MAY_MOVE
        if self.state in (*MOVING, *HANDING, "clearing"):
            return self.state
        if not run_id:
            return self._between_doors(last_run)
        if not needed:
            return "unneeded"
        if self.milled_run == run_id:
            return "share"
        if self.state == "failed" and self.run_id == run_id:
            return "failed"
        if self.state == "requested" or (self.state in ("done", "failed") and self.request):
            begun = other.milled_run == run_id or other.may_move or other.state in HANDING
            return "turn" if begun else "requested"
        return "asks_not" if self.state in ("idle", "done", "failed") else self.state

    def _between_doors(self, last_run: str) -> str:
        if self.state not in ("done", "failed"):
            return self.state
        # What it came to with an earlier door tells nothing of the last one.
        if last_run and self.run_id not in ("", last_run):
            return "idle"
        return "share" if self.state == "done" else "failed"

    def share(self, run_id: str, success: bool | None) -> str:
        """What came of its share of a run: planned, in_work, milled or not_milled.

        Args:
            run_id: The run.
            success: How that ended; None: it has not.
        """
        if success or self.milled_run == run_id:
            return "milled"
        if self.state == "milling" and self.run_id == run_id:
            return "in_work"
        return "planned" if success is None else "not_milled"
