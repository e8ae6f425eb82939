"""Pauses between attempts that double up to a limit, and how long attempts have failed."""

from __future__ import annotations

from collections.abc import Callable


class Backoff:
    """When to try again; does not sleep."""

    def __init__(self, clock: Callable[[], float], first: float, last: float) -> None:
        """Be due at once.

        Args:
            clock: Monotonic clock [s].
            first: First pause [s].
            last: Longest pause [s].
        """
        self._clock = clock
        self._first = first
        self._last = last
        self.reset()

    @property
    def due(self) -> bool:
        """True when the pause is over."""
        return self._clock() >= self._again_at

    def reset(self) -> None:
        """Be due at once and begin with the first pause again."""
        self._pause = self._first
        self._again_at = float("-inf")

    def failed(self) -> float:
        """Begin the next pause and return its length [s]."""
        pause, self._pause = self._pause, min(2.0 * self._pause, self._last)
        self._again_at = self._clock() + pause
        return pause

    def hold(self) -> None:
        """Pause once for the first length without growing."""
        self._again_at = self._clock() + self._first


class Outage:
    """How long something has not worked."""

    def __init__(self, clock: Callable[[], float], limit: float) -> None:
        """Nothing has failed yet.

        Args:
            clock: Monotonic clock [s].
            limit: Longest that is put up with [s].
        """
        self._clock = clock
        self._limit = limit
        self._since: float | None = None

    def over(self) -> None:
        """It works."""
        self._since = None

    def beyond_limit(self) -> bool:
        """It failed just now; True when it has failed for longer than the limit."""
        now = self._clock()
        self._since = now if self._since is None else self._since
        return now - self._since >= self._limit
