"""What must hold while ready is high and the robot reads the file."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.abb.handshake.access import ControllerAccess
from doormill_ros.abb.handshake.state import HandshakeTimeouts
from doormill_ros.abb.link_errors import AcknowledgeTimeoutError, RequestWithdrawnError


class AnnouncedWatch:
    """Looks after an announced file until the robot has read it.

    Args:
        access: Way to the controller's signals and notes.
        clock: Monotonic clock [s].
        timeouts: Its `acknowledge` and `watch`.
    """

    def __init__(
        self, access: ControllerAccess, clock: Callable[[], float], timeouts: HandshakeTimeouts
    ) -> None:
        self._access = access
        self._clock = clock
        self._timeouts = timeouts
        self._deadline = self._watch_at = float("inf")

    def begin(self) -> None:
        """Ready is high from now on."""
        self._deadline = self._clock() + self._timeouts.acknowledge
        self._watch_at = self._clock() + self._timeouts.watch

    def require(self, reported: bool) -> None:
        """Look at the announcement of a request that is high; at the controller's signals every now and then.

        Args:
            reported: The request was reported as high too, and not as fallen in between.

        Raises:
            RequestWithdrawnError: The request is another one.
            AcknowledgeTimeoutError: The robot takes too long.
            LinkError: Ready is not as it was set, or cannot be read.
        """
        if not reported:
            raise RequestWithdrawnError(
                "the request fell and rose again before ready was lowered; request again"
            )
        if self._clock() >= self._deadline:
            raise AcknowledgeTimeoutError(
                f"the controller did not take the file within {self._timeouts.acknowledge:g} s; "
                "check that the milling program runs in automatic mode",
                timeout=self._timeouts.acknowledge,
            )
        if self._clock() >= self._watch_at:
            self._watch_at = self._clock() + self._timeouts.watch
            self._access.require_announced()
