"""Pauses between attempts that double up to a limit."""

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
