"""One run of one door as seen by who started it: what was heard of each stage, and when."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from doormill_ros.cell.errors import RunCanceledError, StageRefusedError, StageTimeoutError


def new_run_id() -> str:
    """A name no run had before: UTC time to the microsecond."""
    return datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")


@dataclass(frozen=True)
class StageLimits:
    """How long a run waits for each stage [s]."""

    recipe: float = 5.0
    picture: float = 10.0
    targets: float = 10.0
    request: float = 20.0
    ready: float = 10.0
    read: float = 60.0
    milling: float = 600.0


@dataclass
class Run:
    """A run in hand. `deliver` and `cancel` come from any thread, `wait_for` from the run's own.

    Attributes:
        run_id: Unique name.
        door_id: What is milled.
        not_before: What comes of a picture taken earlier does not count [s since the epoch]: before the
            controller's request the door may not be clamped yet.
        times: Wall-clock time at which each stage was heard of [s since the epoch].
    """

    run_id: str
    door_id: str
    not_before: float = float("inf")
    times: dict[str, float] = field(default_factory=dict)
    _heard: dict[str, Any] = field(default_factory=dict)
    _canceled: bool = False
    _changed: threading.Condition = field(default_factory=threading.Condition)

    def deliver(self, stage: str, answer: Any, pictured: float) -> None:
        """Note the answer of a stage; the first one that belongs to the request counts.

        Args:
            stage: Which stage.
            answer: With `accepted`, `error_code` and `reason`.
            pictured: When the picture was taken that the answer is about [s since the epoch].
        """
        with self._changed:
            if stage not in self._heard and pictured >= self.not_before:
                self._heard[stage] = answer
                self.times[stage] = time.time()
                self._changed.notify_all()

    def forget(self) -> None:
        """Start over with stages that were heard of: the controller's request changed meanwhile."""
        with self._changed:
            self._heard.clear()
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

    def wait_until(self, condition: Callable[[], Any], limit: float, otherwise: str) -> Any:
        """The first true value of `condition`.

        Args:
            condition: Looked at whenever something was heard, at least every 50 ms.
            limit: Longest wait [s].
            otherwise: What went missing and what to do, for the error.

        Raises:
            StageTimeoutError: Nothing within the limit.
            RunCanceledError: The run was canceled.
        """
        deadline = time.monotonic() + limit
        with self._changed:
            while not (value := condition()):
                if self._canceled:
                    raise RunCanceledError("the run was canceled; start it again when the cell is free")
                left = deadline - time.monotonic()
                if left <= 0.0:
                    raise StageTimeoutError(f"{otherwise} (waited {limit:g} s)", limit=limit)
                self._changed.wait(min(left, 0.05))
            return value

    def wait_for(
        self, stage: str, limit: float, otherwise: str, unless: Callable[[], bool] = lambda: False
    ) -> Any:
        """The answer of a stage, None once `unless` is true; see `wait_until` for the errors.

        Raises:
            StageRefusedError: The stage answered that it cannot be done.
        """
        self.wait_until(lambda: stage in self._heard or unless(), limit, otherwise)
        answer = self._heard.get(stage)
        if answer is None or unless():
            return None
        if not answer.accepted:
            raise StageRefusedError(answer.reason, answer.error_code)
        return answer
