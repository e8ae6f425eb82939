"""What other threads ask of the handshake: to hand over a file, to name a door, to give up."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState
from doormill_ros.abb.link_errors import (
    DoorNameError,
    EmptyTargetFileError,
    HandshakeBusyError,
    LinkError,
    NoRequestError,
    RepeatedRunError,
    RunAbortedError,
    StaleSubmissionError,
)

_RUNS_REMEMBERED = 10_000
LONGEST_NAME = 40  #: of a door; RAPID strings hold 80 and a line of the pendant 40


@dataclass(frozen=True)
class Submission:
    """A complete target file and what it belongs to."""

    run_id: str
    door_id: str
    data: bytes
    request_number: int

    def check_request(self, present: int) -> None:
        """Refuse a file that was made for an earlier request.

        Raises:
            StaleSubmissionError: It was.
        """
        if self.request_number != present:
            raise StaleSubmissionError(
                f"run {self.run_id} was made for request {self.request_number}, the present one is "
                f"{present}; take a new picture of the door",
                run_id=self.run_id,
                request_number=self.request_number,
            )


class Inbox:
    """Holds at most one submission and one order to abort; safe to call from any thread."""

    def __init__(self) -> None:
        self._mutex = threading.Lock()
        self._submission: Submission | None = None
        self._abort_reason: str | None = None
        self._door: tuple[str, Future[None]] | None = None
        self._run_ids: dict[str, None] = {}

    def put(self, submission: Submission, now: HandshakeSnapshot) -> None:
        """Accept the submission or say why not; see `Handshake.submit`."""
        run_id, door_id = submission.run_id, submission.door_id
        if not (submission.data and run_id and door_id):
            raise EmptyTargetFileError(
                f"submitted file has {len(submission.data)} bytes, run id {run_id!r} and door id "
                f"{door_id!r}; all three must have content: generate the file again",
                run_id=run_id,
                door_id=door_id,
            )
        with self._mutex:
            if run_id in self._run_ids:
                raise RepeatedRunError(
                    f"run id {run_id!r} was submitted before; each attempt needs a new one", run_id=run_id
                )
            if not now.request and now.state is not HandshakeState.CLEARING:
                raise NoRequestError(
                    f"run {run_id} for door {door_id} came without a request of the controller (state "
                    f"{now.state.value}); clamp the door and let the robot raise {signals.REQUEST} first",
                    run_id=run_id,
                    state=now.state.value,
                )
            if self._submission is not None or not now.accepts_submission:
                raise HandshakeBusyError(
                    f"run {run_id} cannot be taken in state {now.state.value} ({now.reason}); "
                    "wait for the state 'requested'",
                    run_id=run_id,
                    state=now.state.value,
                )
            submission.check_request(now.request_number)
            self._submission = submission
            self._run_ids[run_id] = None
            if len(self._run_ids) > _RUNS_REMEMBERED:
                del self._run_ids[next(iter(self._run_ids))]

    def take(self) -> Submission | None:
        """Remove and return the submission."""
        with self._mutex:
            submission, self._submission = self._submission, None
            return submission

    def order_abort(self, reason: str) -> None:
        """Remember why the present run shall be given up."""
        with self._mutex:
            self._abort_reason = reason

    def forget_abort(self) -> None:
        """Drop an order that came when there was nothing to give up."""
        with self._mutex:
            self._abort_reason = None

    def name_door(self, door_id: str) -> Future[None]:
        """Remember the name of the door that is being loaded; it takes the place of one not told yet."""
        told: Future[None] = Future()
        if not (door_id.isascii() and door_id.isprintable() and 0 < len(door_id) <= LONGEST_NAME):
            told.set_exception(
                DoorNameError(
                    f"name of the door is {door_id!r}; allowed are 1 to {LONGEST_NAME} printable ASCII characters: "
                    "use the id of a recipe",
                    found=door_id,
                )
            )
            return told
        with self._mutex:
            before, self._door = self._door, (door_id, told)
        if before is not None:
            before[1].cancel()
        return told

    def tell_door(self, write: Callable[[str], None]) -> None:
        """Pass the name on, if there is one."""
        with self._mutex:
            waiting, self._door = self._door, None
        if waiting is None or not waiting[1].set_running_or_notify_cancel():
            return
        try:
            write(waiting[0])
        except LinkError as error:
            waiting[1].set_exception(error)
        else:
            waiting[1].set_result(None)

    def raise_if_aborted(self) -> None:
        """Turn the order into an error, once.

        Raises:
            RunAbortedError: The run was given up.
        """
        with self._mutex:
            reason, self._abort_reason = self._abort_reason, None
        if reason is not None:
            raise RunAbortedError(reason)
