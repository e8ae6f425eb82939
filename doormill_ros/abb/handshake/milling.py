"""How the milling of a file that was handed over ends: by the controller's signals, its note, or never."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.abb import link_errors, signals
from doormill_ros.abb.handshake.access import FAULT_WHILE_MILLING, NO_REASON, ControllerAccess
from doormill_ros.abb.handshake.ledger import RunLedger
from doormill_ros.abb.handshake.state import HandshakeState


class MillingWatch:
    """Looks for the end of milling.

    Args:
        access: Way to the controller's signals and notes.
        clock: Monotonic clock [s].
        limit: Longest milling [s].
    """

    TAKEN_UP = "the robot is busy with a file that was handed over before this start"
    TAKEN_UNSEEN = "the robot had taken the file before it could be taken back, and mills"

    def __init__(self, access: ControllerAccess, clock: Callable[[], float], limit: float) -> None:
        self._access = access
        self._clock = clock
        self._limit = limit
        self._deadline = float("inf")
        self._looks_back = False
        self._announced = ""

    def look_back(self, wanted: bool, announced: str = "") -> None:
        """Take up what the robot took unseen, or nothing any more.

        Args:
            wanted: Whether to look.
            announced: Run that was announced and came to nothing here; empty for any, of a former process of this PC.
        """
        self._looks_back, self._announced = wanted, announced

    def begin(self) -> None:
        """The robot mills from now on."""
        self._deadline = self._clock() + self._limit

    def recall(self, runs: RunLedger) -> tuple[str, bytes] | None:
        """The run that the robot took unseen and mills, and its request's mark; to be asked once the request is low.

        The robot tells by its busy signal, which stays high after a fault until it is home, and by its notes. Of a run
        that it has milled meanwhile it tells the end. None where it mills nothing, or nobody looks back.

        Raises:
            LinkError: The controller cannot be asked.
        """
        if not self._looks_back:
            return None
        busy = self._access.optional_signal(signals.BUSY)
        accepted, mark, milled = self._access.last_runs()
        if self._looked_for(milled):
            runs.recall(milled, True, "the robot noted the end of milling while nobody looked")
        if not busy or not self._looked_for(accepted):
            return None
        runs.recall(accepted, None, self.reason)
        return accepted, mark

    def _looked_for(self, run_id: str) -> bool:
        return not self._announced or run_id == self._announced

    @property
    def reason(self) -> str:
        """Why a run is milled that was recalled."""
        return self.TAKEN_UNSEEN if self._announced else self.TAKEN_UP

    def end(self, request_mark: bytes) -> tuple[HandshakeState, str] | None:
        """State and reason of the end, None while the robot mills.

        Raises:
            MillingTimeoutError: It mills for longer than allowed.
            LinkError: The controller cannot be asked.
        """
        if self._access.optional_signal(signals.FAULT):
            reason = self._access.reason_of_fault(request_mark) or NO_REASON
            return HandshakeState.FAILED, f"{FAULT_WHILE_MILLING}{reason}"
        if self._access.optional_signal(signals.DONE):
            return HandshakeState.DONE, "the robot reported the end of milling"
        if self._clock() >= self._deadline:
            raise link_errors.MillingTimeoutError(
                f"the robot did not report the end of milling within {self._limit:g} s; look at it",
                timeout=self._limit,
            )
        return None

    def end_before_request(self, run_id: str) -> tuple[bool, str]:
        """Whether a run was milled whose end nobody saw before the next request rose, and why that is thought.

        The signal of the end was up and is down again between two looks; the robot's note stays.
        """
        if self._access.was_milled(run_id):
            return True, "the robot noted the end of milling before it requested again"
        return False, "the robot requested again without an end of milling; see its pendant"
