"""One run of one door as seen by who started it: what was heard of each stage, and when."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Protocol, TypeVar

from doormill_ros.cell.errors import CellBusyError, RunCanceledError, StageRefusedError, StageTimeoutError
from doormill_ros.cell.run.clock import FUTURE, Clock, ClockWatch, step_text
from doormill_ros.cell.run.waiting import wait_until

LOCALIZATION, TARGETS = "localization", "targets"
REMEMBERED = 16  # runs that ended

Value = TypeVar("Value")


def new_run_id() -> str:
    """A name no run had before: UTC time to the microsecond."""
    return datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")


@dataclass(frozen=True)
class StageLimits:
    """How long a run waits for each stage [s]."""

    recipe: float = 10.0
    picture: float = 10.0
    targets: float = 10.0
    request: float = 20.0
    ready: float = 10.0
    read: float = 60.0
    milling: float = 600.0
    inspection: float = 180.0


class StageAnswer(Protocol):
    """What every stage says of its part of a run."""

    accepted: bool
    error_code: int
    reason: str


@dataclass
class Run:
    """A run in hand. `deliver` and `cancel` come from any thread, `wait_for` from the run's own.

    Attributes:
        run_id: Unique name.
        door_id: What is milled.
        clock: Its time.
        require: Called while the run waits; raises when what it waits for cannot come any more.
        not_before: What comes of a picture taken earlier does not count [s since the epoch]: before the
            controller's request the door may not be clamped yet.
        times: Wall-clock time at which each stage was heard of [s since the epoch].
        pictured: When the picture was taken that the stage's answer is about [s since the epoch].
    """

    run_id: str
    door_id: str
    clock: Clock = field(default_factory=Clock)
    require: Callable[[], None] = lambda: None
    not_before: float = float("inf")
    times: dict[str, float] = field(default_factory=dict)
    pictured: dict[str, float] = field(default_factory=dict)
    _heard: dict[str, Any] = field(default_factory=dict)
    _localized: set[float] = field(default_factory=set)  # pictures of which the localizer told under this run
    # Targets by pictures of which it did not yet.
    _early: dict[float, StageAnswer] = field(default_factory=dict)
    _canceled: bool = False
    _changed: threading.Condition = field(default_factory=threading.Condition)

    def __post_init__(self) -> None:
        """Watch the clock."""
        self._watch = ClockWatch(self.clock)

    @property
    def steps(self) -> list[float]:
        """By how much its clock was set each time in the run [s]."""
        return self._watch.steps

    def deliver(self, stage: str, answer: StageAnswer, pictured: float) -> None:
        """Note the answer of a stage; the first one that belongs to the request counts, and none from the future.

        Targets count only with a localization of the same picture under this run: a pose has no run, and one that was
        found for the door before may have met this run's recipe.

        Args:
            stage: Which stage.
            answer: What it says.
            pictured: When the picture was taken that the answer is about [s since the epoch].
        """
        with self._changed:
            if not self.not_before <= pictured <= self.clock.wall() + FUTURE:
                return
            if stage == TARGETS and pictured not in self._localized:
                self._early[pictured] = answer
                return
            self._hear(stage, answer, pictured)
            if stage == LOCALIZATION:
                self._localized.add(pictured)
                if pictured in self._early:
                    self._hear(TARGETS, self._early.pop(pictured), pictured)

    def _hear(self, stage: str, answer: StageAnswer, pictured: float) -> None:
        if stage not in self._heard:
            self._heard[stage] = answer
            self.times[stage], self.pictured[stage] = self.clock.wall(), pictured
            self._changed.notify_all()

    def forget(self) -> None:
        """Start over with stages that were heard of: the controller's request changed meanwhile."""
        with self._changed:
            self._heard.clear()
            self._localized.clear()
            self._early.clear()
            self.not_before = float("inf")

    def cancel(self) -> None:
        """End the run at its next wait."""
        with self._changed:
            self._canceled = True
            self._changed.notify_all()

    def notify(self) -> None:
        """Look again: something outside may have changed what `wait_until` waits for."""
        with self._changed:
            self._changed.notify_all()

    def wait_until(self, condition: Callable[[], Value | None], limit: float, otherwise: str) -> Value:
        """The first true value of `condition`.

        Args:
            condition: Looked at whenever something was heard, at least every 50 ms.
            limit: Longest wait [s].
            otherwise: What went missing and what to do, for the error.

        Raises:
            StageTimeoutError: Nothing within the limit.
            RunCanceledError: The run was canceled.
            CellError: By `require`.
        """

        def look() -> Value | None:
            value = condition()
            if not value and self._canceled:
                raise RunCanceledError("the run was canceled; start it again when the cell is free")
            if not value:
                self.require()
            return value

        try:
            return wait_until(self._changed, look, limit, otherwise, self._watch.now)
        except StageTimeoutError as error:
            if not self.steps:
                raise
            said = f"{error.message}; {step_text(self.steps[-1])} in the run"
            raise StageTimeoutError(said, limit=limit) from None

    def wait_for(
        self, stage: str, limit: float, otherwise: str, unless: Callable[[], bool] = lambda: False
    ) -> Any:
        """The answer of a stage, None once `unless` is true; see `wait_until` for the errors.

        Raises:
            StageRefusedError: The stage answered that it cannot be done.
        """
        self.wait_until(lambda: stage in self._heard or unless(), limit, otherwise)
        answer = self._heard.get(stage)
        if answer is not None and not answer.accepted:
            self._watch.now()  # a stage refuses old pictures; perhaps they are not
        if answer is None or unless():
            return None
        if not answer.accepted:
            raise StageRefusedError(answer.reason, answer.error_code)
        return answer


class RunDesk:
    """Keeps the run in hand, one at a time, and passes on to it what is heard; from any thread."""

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or Clock()
        self._lock = threading.Lock()
        self._run: Run | None = None
        self._ended: deque[str] = deque(maxlen=REMEMBERED)

    def begin(self, door_id: str, run_id: str = "") -> Run:
        """A run for a door, of its own or, by its id, one that is in hand elsewhere.

        Raises:
            CellBusyError: Another door is being milled.
        """
        with self._lock:
            if self._run is not None:
                raise CellBusyError(
                    f"door {door_id} was refused: {self._run.door_id} is being milled; wait until it is done"
                )
            self._run = Run(run_id or new_run_id(), door_id, self._clock)
            return self._run

    def end(self) -> None:
        """The run in hand is over."""
        with self._lock:
            if self._run is not None:
                self._ended.append(self._run.run_id)
            self._run = None

    def deliver(self, stage: str, run_id: str, answer: StageAnswer, pictured: float) -> bool:
        """Pass a stage's answer to the run in hand, see `Run.deliver`; False when it belongs to no run of this desk."""
        run = self._run
        if run is None or run_id != run.run_id:
            # A second picture of a run may be answered when its door is milled already.
            return run_id in self._ended
        run.deliver(stage, answer, pictured)
        return True

    def notify(self) -> None:
        """Let the run in hand, if any, look again."""
        run = self._run
        if run is not None:
            run.notify()

    def cancel(self) -> None:
        """End the run in hand, if any, at its next wait."""
        run = self._run
        if run is not None:
            run.cancel()
