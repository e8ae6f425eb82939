"""The controller's present request: its mark, its deadline, and whether another one may have come unseen."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.abb.handshake.access import ControllerAccess
from doormill_ros.abb.link_errors import SubmissionTimeoutError


class PresentRequest:
    """Kept by the stepping thread alone.

    Attributes:
        mark: What the robot program wrote about it; empty from a program that marks none.
        missed: The signal could not be read for a while, so that it may have fallen and risen.
    """

    def __init__(self, access: ControllerAccess, clock: Callable[[], float], limit: float) -> None:
        """Begin with none; `limit` is the longest wait for its file [s]."""
        self._access = access
        self._clock = clock
        self._limit = limit
        self._deadline = float("inf")
        self.mark = b""
        self.missed = True

    def begin(self) -> None:
        """It has risen; what fails until `seen` makes it count as new once the link works.

        Raises:
            LinkError: Its mark cannot be read.
        """
        self.missed = True
        self.mark = self._access.request_mark()
        self._deadline = self._clock() + self._limit

    def withdrawn(self) -> None:
        """It has fallen, so that a high one is another one."""
        self.missed, self.mark = True, b""

    def is_the_same(self) -> bool:
        """Whether a high one is the one that began, by its mark where the signal was out of sight.

        Raises:
            LinkError: The mark cannot be read.
        """
        return not self.missed or (self.mark != b"" and self._access.request_mark() == self.mark)

    def require_in_time(self) -> None:
        """Let the wait for the file go on.

        Raises:
            SubmissionTimeoutError: It has lasted too long.
        """
        if self._clock() >= self._deadline:
            raise SubmissionTimeoutError(
                f"no target file within {self._limit:g} s after the request; "
                "look at the localizer's and path generator's reports",
                timeout=self._limit,
            )
