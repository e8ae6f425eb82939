"""Hand one verified target file to the controller for each of its requests, or none.

    request high -> ready low, old file gone -> write -> read back, compare, check -> ready high
    -> controller reads the file -> request low -> ready low, file gone

Whatever goes wrong leads to CLEARING: ready low and the file removed, tried again until both have
been read back. docs/controller-link.md holds the argument why no fault lets a wrong file be milled.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

from doormill_ros.abb import link_errors, signals
from doormill_ros.abb.backoff import Backoff, Outage
from doormill_ros.abb.handshake.access import ControllerAccess
from doormill_ros.abb.handshake.announced import AnnouncedWatch
from doormill_ros.abb.handshake.failure import may_be_taken, sentence, state_after
from doormill_ros.abb.handshake.inbox import Inbox, Submission
from doormill_ros.abb.handshake.ledger import RunLedger
from doormill_ros.abb.handshake.milling import MillingWatch
from doormill_ros.abb.handshake.request import PresentRequest
from doormill_ros.abb.handshake.state import CLEARED, HandshakeSnapshot, HandshakeTimeouts, RunOutcome
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.abb.link_errors import LinkError
from doormill_ros.abb.transport import Transport

_LOG = logging.getLogger(__name__)


class Handshake:
    """The state machine; `step` drives it from one thread, `submit` and `abort` come from any."""

    def __init__(
        self,
        transport: Transport,
        clock: Callable[[], float] = time.monotonic,
        timeouts: HandshakeTimeouts | None = None,
        file_name: str = signals.TARGET_FILE,
        check: Callable[[bytes, str, str], object] | None = None,
        on_change: Callable[[HandshakeSnapshot], None] | None = None,
    ) -> None:
        """Touch nothing yet; call `on_start` next.

        Args:
            transport: Way to the controller.
            clock: Monotonic clock [s]; the wall clock may step and is never used.
            timeouts: Limits of the waits.
            file_name: Target file the controller opens.
            check: Called with the bytes read back, run id and door id; raises an `AbbError` when the file is
                not a complete target file of that run and door.
            on_change: Called from the stepping thread after each change of state.

        Raises:
            FileNameError: `file_name` is not a plain file name.
        """
        self._transport = transport
        self._clock = clock
        self._timeouts = timeouts or HandshakeTimeouts()
        self._access = ControllerAccess(transport, clock, file_name, check)
        self._announced = AnnouncedWatch(self._access, clock, self._timeouts)
        self._milling = MillingWatch(self._access, clock, self._timeouts.milling)
        self._on_change = on_change
        self._inbox = Inbox()
        self._runs = RunLedger()
        # Replaced as a whole by the stepping thread only, so other threads may read it without a lock.
        self._snapshot = HandshakeSnapshot(State.CLEARING, "not started", clock())
        self._after_clearing: tuple[State, str, int] = (State.IDLE, "started", 0)
        self._request = PresentRequest(self._access, clock, self._timeouts.submission)
        self._watch_at = float("-inf")
        self._retry = Backoff(clock, self._timeouts.retry_first, self._timeouts.retry_last)
        self._unreadable = Outage(clock, self._timeouts.link_loss)

    @property
    def snapshot(self) -> HandshakeSnapshot:
        """What an observer may see; from any thread."""
        return self._snapshot

    def outcome(self, run_id: str) -> RunOutcome | None:
        """How the run ended, None while it goes on or when it is unknown; from any thread."""
        return self._runs.outcome(run_id)

    def on_start(self) -> HandshakeSnapshot:
        """Lower ready and remove the target file, whatever a former process left; then as `step`."""
        self._begin_clearing(State.IDLE, "started", 0)
        self._access.expect_latecomers()
        self._request.missed = True
        self._milling.look_back(True)
        return self.step()

    def submit(self, run_id: str, door_id: str, data: bytes, request_number: int | None = None) -> None:
        """Give the file for the present request; the next step writes, verifies and announces it.

        Args:
            run_id: Never used before.
            door_id: Door the file mills.
            data: The complete target file.
            request_number: The snapshot's request number when work on this file began; a file that was
                made for an earlier request is refused. None skips that check.

        Raises:
            EmptyTargetFileError: No content, run id or door id.
            RepeatedRunError: The run id was used before.
            NoRequestError: The controller asks for nothing.
            HandshakeBusyError: Another file is being handed over, or the controller is not cleared.
            StaleSubmissionError: The file was made for an earlier request.
        """
        now = self._snapshot
        number = now.request_number if request_number is None else request_number
        self._inbox.put(Submission(run_id, door_id, bytes(data), number), now)
        self._transport.wake()

    def abort(self, reason: str) -> None:
        """Give up the present request or run, for a reason of one sentence: ready low and the file gone in a step."""
        self._inbox.order_abort(reason)
        self._transport.wake()

    def expect_door(self, door_id: str) -> Future[None]:
        """Tell the robot program which door is being loaded; the future holds the `LinkError` of a failure."""
        told = self._inbox.name_door(door_id)
        self._transport.wake()
        return told

    def wait(self, timeout: float) -> None:
        """Sleep until the next `step` is worth its while [s]."""
        self._transport.wait(timeout)

    def close(self) -> None:
        """Lower ready, remove the file as far as the link allows, and close the transport."""
        try:
            self._access.clear()
        except LinkError as error:
            _LOG.error("closing with the controller not cleared: %s", error)
        self._transport.close()

    def step(self) -> HandshakeSnapshot:
        """Do what can be done now without waiting for the controller; returns the snapshot.

        A step takes at most a few transport operations, each within the transport's timeout, and
        raises no `LinkError`: what goes wrong shows in the snapshot.
        """
        self._inbox.tell_door(self._access.name_door)
        try:
            if self._snapshot.state is State.CLEARING:
                self._step_clearing()
            elif self._snapshot.state is State.READY:
                self._step_ready()
            else:
                self._step_cleared()
        except LinkError as error:
            self._fail(error)
        return self._snapshot

    def _step_clearing(self) -> None:
        if not self._retry.due:
            return
        after, reason, code = self._after_clearing
        try:
            self._access.clear()
            high = self._access.request_is_high()
            same = high and self._request.is_the_same()
            former = None if high else self._milling.recall(self._runs)
        except LinkError as error:
            self._request.missed = True
            self._retry.failed()
            reason = f"{reason}; clearing the controller: {error.message}"
            if self._snapshot.reason != reason:
                self._enter(State.CLEARING, reason, error.code)
            return
        if self._access.in_doubt:
            self._retry.hold()
            return
        self._inbox.forget_abort()
        self._watch_at = self._clock() + self._timeouts.watch
        if former is not None:
            after, reason, code = State.MILLING, self._milling.reason, 0
            run_id, self._request.mark = former
            self._update(run_id=run_id, door_id=self._runs.door_of(run_id))
        if not high:
            self._milling.look_back(False)
        if after is State.MILLING:
            self._milling.begin()
        # A request that could not be read for a while may have fallen and risen: a high one counts as new, and a file
        # that was made before is not taken for it, unless the robot program's mark says that it is the one waited for.
        known = high and self._snapshot.request and after in (State.REQUESTED, State.FAILED) and same
        if after is State.REQUESTED and not known:
            after = State.FAILED
        self._enter(after, reason, code, request=known)
        self._request.missed = False

    def _step_cleared(self) -> None:
        was_high, reported = self._snapshot.request, self._transport.read_request()
        high = reported if reported == was_high else self._access.request_is_high()
        self._update(request=high)
        if high and not (was_high and reported):  # it rose, or it fell and rose again between two looks
            self._begin_request()
        elif self._snapshot.state is State.REQUESTED:
            self._step_requested(high)
        elif self._snapshot.state is State.FAILED:
            self._step_failed(high)
        else:
            self._inbox.forget_abort()
            if self._snapshot.state is State.MILLING:
                self._step_milling()
        if self._snapshot.state in CLEARED and self._clock() >= self._watch_at:
            self._watch_at = self._clock() + self._timeouts.watch
            self._access.require_ready(False)

    def _begin_request(self) -> None:
        before = self._snapshot
        number = before.request_number + 1
        if before.state is State.MILLING:
            milled, reason = self._milling.end_before_request(before.run_id)
            self._runs.end_milling(before.run_id, milled, reason)
            if milled:
                self._enter(State.DONE, reason, 0)
        context = f" (before: {before.reason})" if before.error_code else ""
        self._drop_submission(
            link_errors.StaleSubmissionError("made for an earlier request; take a new picture")
        )
        # Its mark is read before anybody is told of the request: a picture is then never older than the mark.
        self._request.begin()
        self._update(request_number=number, times={}, run_id="", door_id="")
        self._inbox.forget_abort()
        self._enter(State.REQUESTED, f"request {number}: waiting for the target file{context}", 0)
        self._access.clear()
        self._request.missed = False

    def _step_requested(self, high: bool) -> None:
        if not high:
            raise link_errors.RequestWithdrawnError(
                "the request fell before a file was ready; check the robot program, then request again"
            )
        self._inbox.raise_if_aborted()
        submission = self._inbox.take()
        if submission is not None:
            self._hand_over(submission)
        else:
            self._request.require_in_time()

    def _step_failed(self, high: bool) -> None:
        if not high:
            self._drop_submission(
                link_errors.RequestWithdrawnError("the request fell before the file was written")
            )
            # Which also looks whether the robot took what was called back.
            self._begin_clearing(State.IDLE, f"no request; before: {self._snapshot.reason}", 0)
            self._step_clearing()
        elif (submission := self._inbox.take()) is not None:
            self._hand_over(submission)
        else:
            self._inbox.forget_abort()

    def _hand_over(self, submission: Submission) -> None:
        self._milling.look_back(False)
        self._runs.begin(submission)
        submission.check_request(self._snapshot.request_number)
        self._update(run_id=submission.run_id, door_id=submission.door_id)
        name = self._access.file_name
        self._enter(State.WRITING, f"writing {name} ({len(submission.data)} bytes)", 0)
        self._access.write(submission)
        self._inbox.raise_if_aborted()
        self._enter(State.VERIFYING, f"reading {name} back", 0)
        self._access.verify(submission)
        self._inbox.raise_if_aborted()
        self._enter(State.RAISING, f"{name} verified, setting {signals.READY}", 0)
        self._access.announce(submission, self._request.mark)
        self._announced.begin()
        self._unreadable.over()
        self._enter(State.READY, f"{name} verified and announced; the controller may read it", 0)

    def _step_ready(self) -> None:
        self._inbox.raise_if_aborted()
        try:
            reported = self._transport.read_request()
            high = reported or self._access.request_is_high()
        except LinkError:
            self._request.missed = True
            if self._unreadable.beyond_limit():
                raise
            return
        self._unreadable.over()
        if not high:
            self._acknowledged()
        else:
            self._announced.require(reported)

    def _acknowledged(self) -> None:
        self._update(request=False)
        self._enter(State.ACKNOWLEDGED, "the controller has read the file", 0)
        self._access.require_taken(self._snapshot.run_id, self._request.mark)
        self._finish(handed_over=True, code=0, reason="file handed over")
        self._begin_clearing(State.MILLING, "file handed over, the robot mills", 0)
        self._step_clearing()

    def _step_milling(self) -> None:
        if (end := self._milling.end(self._request.mark)) is not None:
            state, reason = end
            self._runs.end_milling(self._snapshot.run_id, state is State.DONE, reason)
            self._enter(state, reason, 0)

    def _fail(self, error: LinkError) -> None:
        state = self._snapshot.state
        _LOG.warning("handshake, %s: %s", state.value, error.message)
        after = state_after(state, error)
        if state is State.MILLING and after is State.FAILED:
            self._runs.end_milling(self._snapshot.run_id, False, error.message)
        self._request.missed |= error.connection
        if isinstance(error, link_errors.RequestWithdrawnError):
            self._request.withdrawn()
        reason = sentence(state, error)
        if may_be_taken(state):
            self._milling.look_back(True, self._snapshot.run_id)
        self._finish(handed_over=False, code=error.code, reason=reason)
        self._drop_submission(error)
        self._begin_clearing(after, reason, error.code)
        self._step_clearing()

    def _drop_submission(self, error: LinkError) -> None:
        submission = self._inbox.take()
        if submission is not None:
            self._runs.begin(submission)
            self._finish(handed_over=False, code=error.code, reason=error.message)

    def _finish(self, handed_over: bool, code: int, reason: str) -> None:
        outcome = self._runs.end(handed_over, code, reason)
        if outcome is not None:
            self._update(run_id=outcome.run_id, door_id=outcome.door_id, outcome=outcome)

    def _begin_clearing(self, then: State, reason: str, code: int) -> None:
        self._after_clearing = (then, reason, code)
        self._retry.reset()
        self._enter(State.CLEARING, f"{reason}; clearing the controller", code)

    def _update(self, **changes: Any) -> None:
        self._snapshot = replace(self._snapshot, **changes)

    def _enter(self, state: State, reason: str, code: int, **changes: Any) -> None:
        now = self._clock()
        times = {**self._snapshot.times, state.value: now}
        if state is State.REQUESTED:  # a request that outlasts a break of the link has begun before it
            times[state.value] = self._snapshot.times.get(state.value, now)
        self._update(state=state, reason=reason, since=now, error_code=code, times=times, **changes)
        if self._on_change is not None:
            self._on_change(self._snapshot)
