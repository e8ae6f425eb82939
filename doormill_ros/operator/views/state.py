"""What the operator's page shows, as plain values; every change makes a new view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.operator.views.advice import Advice, next_step
from doormill_ros.operator.views.captioned_picture import EncodedPicture
from doormill_ros.operator.views.door_view import DoorView
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.fault import Fault
from doormill_ros.operator.views.model_view import ModelView
from doormill_ros.operator.views.moments import age, steady
from doormill_ros.operator.views.pair_advice import pair_step
from doormill_ros.operator.views.pair_view import PairView
from doormill_ros.operator.views.robot_view import RobotView
from doormill_ros.operator.views.runs_view import RunsView
from doormill_ros.operator.views.short_text import short
from doormill_ros.operator.views.situation import MAY_MOVE, Situation, may_move_in, situation, told_in_run

HISTORY = 50  # runs


@dataclass(frozen=True)
class CellView:
    """The cell at one moment.

    Attributes:
        bridge_present: The ABB bridge gives signs of life.
        state: State of the handshake with the controller, empty before it was heard of.
        state_reason: Why it is in that state.
        state_code: Code of the error that led there, 0 when none did.
        state_run: Run that it is about, empty when about none.
        state_door: Door of that run.
        state_since: When it came into that state, by the steady clock [s]; None: not known.
        request: The controller asks for targets.
        may_move: The robot has its targets, or was about to read them, and has not come to an end since.
        run_id: Run in hand, empty when there is none.
        door_id: Door of that run.
        run_since: When that run began, by the steady clock [s]; None: not known.
        stage: Stage of that run, empty when not heard of.
        progress: Share of the run that is done, 0..1.
        refusal: Why the door in hand or the last one was refused; empty when it was not.
        refusal_code: Its error code.
        notice: Answer to what the operator asked for on this page.
        notice_code: Its error code, 0 when it has none.
        faults: Nodes in error.
        history: Ended runs, the newest first.
        picture: The latest picture worth showing.
        model: What the monitor of the model said last; None where there is none.
        runs: What it said last of the bags of runs; None where there is none.
        drawing: The door of the run in hand, or of the last one.
        pair: Both robots where two share the doors: bridge and handshake are told there; None for one robot.
    """

    bridge_present: bool = False
    state: str = ""
    state_reason: str = ""
    state_code: int = 0
    state_run: str = ""
    state_door: str = ""
    state_since: float | None = None
    request: bool = False
    may_move: bool = False
    run_id: str = ""
    door_id: str = ""
    run_since: float | None = None
    stage: str = ""
    progress: float = 0.0
    refusal: str = ""
    refusal_code: int = 0
    notice: str = ""
    notice_code: int = 0
    faults: dict[str, Fault] = field(default_factory=dict)
    history: tuple[EndedRun, ...] = ()
    picture: EncodedPicture | None = None
    model: ModelView | None = None
    runs: RunsView | None = None
    drawing: DoorView | None = None
    pair: PairView | None = None

    def with_robot(self, number: int, change: Callable[[RobotView], RobotView]) -> CellView:
        """One of two robots changed."""
        pair = self.pair or PairView()
        return replace(self, pair=pair.with_robot(change(pair.robots[number - 1])))

    def with_robot_handshake(
        self, number: int, state: str, reason: str, run_id: str, request: bool, since: float, error_code: int
    ) -> CellView:
        """As `with_handshake`, of one of two robots."""
        told = state, short(reason), run_id, request, steady(since), error_code
        return self.with_robot(number, lambda robot: robot.told(*told))

    def with_bridge(self, present: bool) -> CellView:
        """The bridge was heard of lately, or not."""
        return replace(self, bridge_present=present)

    def with_handshake(
        self,
        state: str,
        reason: str,
        run_id: str = "",
        door_id: str = "",
        request: bool = False,
        since: float = 0.0,
        error_code: int = 0,
    ) -> CellView:
        """The handshake changed; `since` in seconds since the epoch, 0 where nobody tells."""
        return replace(
            self,
            bridge_present=True,
            state=state,
            state_reason=short(reason),
            state_code=error_code,
            state_run=run_id,
            state_door=short(door_id),
            request=request,
            may_move=may_move_in(state, self.may_move),
            state_since=steady(since),
        )

    def with_run(self, run_id: str, door_id: str, since: float = 0.0) -> CellView:
        """A recipe was fetched for a run; one that has ended is not in hand again; `since` as in `with_handshake`."""
        if run_id == self.run_id or any(run.run_id == run_id for run in self.history):
            return self
        return replace(
            self,
            run_id=run_id,
            door_id=short(door_id),
            run_since=steady(since),
            stage="recipe",
            progress=0.0,
            refusal="",
            notice="",
        )

    def with_stage(self, stage: str, progress: float) -> CellView:
        """The run in hand reached a stage; ignored while no run is in hand."""
        if not self.run_id:
            return self
        return replace(self, stage=short(stage), progress=min(max(progress, 0.0), 1.0))

    def with_refused_picture(self, run_id: str, reason: str, error_code: int = 0) -> CellView:
        """The door of the run in hand was not found in the picture."""
        if run_id != self.run_id:
            return self
        return replace(self, refusal=short(reason), refusal_code=error_code)

    def with_found_door(self, run_id: str) -> CellView:
        """The door of the run in hand was found: an earlier picture's refusal is over."""
        return replace(self, refusal="") if run_id == self.run_id else self

    def with_ended(self, run: EndedRun) -> CellView:
        """A run ended; each counts once."""
        if any(run.run_id == other.run_id for other in self.history):
            return self
        run = replace(run, door_id=short(run.door_id), message=short(run.message))
        history = (run, *self.history)[:HISTORY]
        if self.run_id not in ("", run.run_id):
            # How another run ended is told late: the page speaks of the one in hand.
            return replace(self, history=history)
        return replace(
            self,
            run_id="",
            door_id="",
            stage="",
            progress=0.0,
            refusal="" if run.success else run.message,
            refusal_code=run.error_code,
            notice="",
            history=history,
        )

    def with_inspection(
        self, run_id: str, inspection: MeasuredDoor, at: float = 0.0, in_cell: bool = False
    ) -> CellView:
        """The door of a run that ended was measured, perhaps long after; see `EndedRun.found`."""
        found = inspection, at, in_cell
        history = tuple(run.found(*found) if run.run_id == run_id else run for run in self.history)
        if history == self.history:
            return self
        newest = history[0]
        if self.run_id or newest == self.history[0]:
            return replace(self, history=history)  # the page speaks of another door
        refusal = "" if newest.success else newest.message
        return replace(self, history=history, refusal=refusal, refusal_code=newest.error_code)

    def with_history(self, runs: tuple[EndedRun, ...]) -> CellView:
        """Runs that ended before the page was there, the newest first."""
        return replace(self, history=runs[:HISTORY])

    def with_notice(self, notice: str, error_code: int = 0) -> CellView:
        """What the operator asked for was answered."""
        return replace(self, notice=short(notice), notice_code=error_code)

    def with_fault(self, node: str, message: str, error_code: int = 0) -> CellView:
        """A node is in error; an empty message means that it no longer is."""
        faults = {name: fault for name, fault in self.faults.items() if name != node}
        if message:
            faults[node] = Fault(short(message), error_code)
        return replace(self, faults=dict(sorted(faults.items())))

    def with_picture(
        self,
        data: bytes,
        media_type: str,
        caption: str,
        key: str = "",
        values: Mapping[str, str] | None = None,
    ) -> CellView:
        """A new picture; key and values of its caption as in `EncodedPicture`."""
        number = self.picture.number + 1 if self.picture else 1
        shown = {name: short(value) for name, value in (values or {}).items()}
        return replace(self, picture=EncodedPicture(data, media_type, short(caption), number, key, shown))

    def with_drawing(self, drawing: DoorView) -> CellView:
        """The recipe of a run tells how its door looks; the one drawn already keeps what is known of it."""
        if self.draws(drawing.run_id):
            return self
        pair = self.pair and self.pair.of_run(drawing.run_id, drawing.robots)
        return replace(self, drawing=drawing, pair=pair)

    def with_plan(
        self, run_id: str, times: Mapping[str, tuple[float, float]], robot: int | None = None
    ) -> CellView:
        """When each feature of a run's door is milled, by which of two robots; of another door's it is passed over."""
        return self._redrawn(run_id, lambda drawing: drawing.with_plan(times, robot))

    def with_measured(self, run_id: str, found: Mapping[str, float], tolerance: float) -> CellView:
        """How far the features of a run's door are off; of another door's it is passed over."""
        return self._redrawn(run_id, lambda drawing: drawing.with_measured(found, tolerance))

    def draws(self, run_id: str) -> bool:
        """The door drawn is that of this run."""
        return self.drawing is not None and self.drawing.run_id == run_id

    def _redrawn(self, run_id: str, change: Callable[[DoorView], DoorView]) -> CellView:
        if self.drawing is None or not self.draws(run_id):
            return self
        return replace(self, drawing=change(self.drawing))

    def with_model(self, model: ModelView) -> CellView:
        """The monitor of the model said something."""
        return replace(self, model=model.shortened())

    def with_runs(self, runs: RunsView) -> CellView:
        """The monitor said something of the bags of runs."""
        return replace(self, runs=runs.shortened())

    def _situation(self) -> tuple[Situation, int, float | None]:
        """State and reason of the door that the page speaks of, code and beginning of that state."""
        last = self.history[0].run_id if self.history else ""
        if self.pair is not None:
            found, lead = self.pair.situation(self.run_id, self.door_id, last)
            return found, lead.code, lead.since
        found = situation(
            self.state,
            self.state_reason,
            (self.state_run, self.state_door),
            (self.run_id, self.door_id),
            last,
            self.request,
            self.may_move or told_in_run(self.state_run, self.run_id, self.state_code),
        )
        return found, self.state_code, self.state_since

    def _step(self, seen: Situation) -> Advice:
        """What to do now; follows from the same as the situation."""
        last = self.history[0] if self.history else None
        faults = {node: fault.message for node, fault in self.faults.items()}
        spoiled = last is not None and last.error_code == OutOfToleranceError.code
        stopped = self.model.message if self.model is not None and self.model.stopped else ""
        in_hand = self.run_id != ""
        if self.pair is None:
            milled = seen.state == "done" and last is not None and last.run_id == self.state_run
            state = MAY_MOVE if seen.key == MAY_MOVE else seen.state
            door = last.door_id if last else self.state_door
            return next_step(
                self.bridge_present, state, in_hand, self.refusal, faults, spoiled, milled, stopped, door
            )
        run_id = last.run_id if last else ""
        done = self.pair.milled(run_id)
        refused = self.refusal != "" or (last is not None and not last.success and done != ())
        lacking = set(self.pair.workers(run_id)) > set(done)
        does = self.pair.does(self.run_id, run_id)
        return pair_step(does, in_hand, refused, faults, spoiled, done, lacking, stopped)

    def document(self) -> dict[str, Any]:
        """JSON-able content of the page; the picture by its number."""
        seen, code, since = self._situation()
        step = self._step(seen)
        last = self.history[0].run_id if self.history else ""
        pair = self.pair
        return {
            "state": seen.state if self.bridge_present or pair else "",
            "state_reason": seen.reason,
            "state_code": code if seen.told else 0,
            "situation": {"key": seen.key, "door": seen.door, "before": seen.before, "ended": seen.ended},
            "state_age": age(since if seen.told else self.run_since if self.run_id else None),
            "robots": [] if pair is None else pair.document(pair.does(self.run_id, last)),
            "urgency": step.urgency,
            "next_step": step.text,
            "step": {"key": step.key, "values": dict(step.values)},
            "run_id": self.run_id,
            "door_id": self.door_id,
            "stage": self.stage,
            "progress": self.progress,
            "refusal": self.refusal,
            "refusal_code": self.refusal_code,
            "notice": self.notice,
            "notice_code": self.notice_code,
            "faults": [{"node": node, **asdict(fault)} for node, fault in self.faults.items()],
            "history": [
                {**asdict(run), "outcome": run.outcome, "came_to": run.came_to} for run in self.history
            ],
            "picture": None
            if self.picture is None
            else {
                "number": self.picture.number,
                "caption": self.picture.caption,
                "key": self.picture.key,
                "values": dict(self.picture.values),
            },
            "model": None if self.model is None else self.model.document(),
            "runs": None if self.runs is None else self.runs.document(),
            "drawing": self._drawn(),
        }

    def _drawn(self) -> dict[str, Any] | None:
        if self.drawing is None:
            return None
        run_id = self.drawing.run_id
        ended = next((run.success for run in self.history if run.run_id == run_id), None)
        shares = self.pair.shares(run_id, ended) if self.pair is not None else {}
        return self.drawing.document(self.run_id == run_id and self.stage == "milling", ended, shares)
