"""The two times of a run: one that only goes on, and one that somebody may set."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

#: A stamp further ahead than this is no clock's doing [s].
FUTURE = 1.0
#: A simulated clock may go so many times as fast as the real one and was not set for that.
FASTEST = 20.0


@dataclass(frozen=True)
class Clock:
    """The time of a run: `monotonic` for its limits, `wall` for what it says and for stamps [s].

    Attributes:
        was_set: Called in a run when `wall` was set, with by how much [s].
    """

    monotonic: Callable[[], float] = time.monotonic
    wall: Callable[[], float] = time.time
    was_set: Callable[[float], None] = lambda step: None


class ClockWatch:
    """Tells the time by `clock.monotonic`, and notices thereby that `clock.wall` was set.

    Attributes:
        steps: By how much it was set each time, forwards positive [s].
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._before: tuple[float, float] | None = None
        self.steps: list[float] = []

    def now(self) -> float:
        """What `clock.monotonic` says [s].

        To be asked often: what a fast clock may gain between two times is not told from a step.
        """
        early, at, late = self._clock.wall(), self._clock.monotonic(), self._clock.wall()
        if abs(late - early) > 0.4 * FUTURE:
            return at  # set just now, or the process was kept waiting; the next time tells
        if self._before is not None:
            passed = at - self._before[0]
            step = late - self._before[1] - passed
            if abs(step) > FUTURE + FASTEST * passed:
                self.steps.append(step)
                self._clock.was_set(step)
        self._before = at, late
        return at


def step_text(step: float) -> str:
    """What was done to the clock, in words.

    Args:
        step: Forwards positive [s].
    """
    return f"the clock was set {'forwards' if step > 0.0 else 'back'} by {abs(step):.1f} s"


class EvenClock:
    """The time of the wall clock when it was made, and from then on what went by [ns since the epoch]."""

    def __init__(
        self, wall: Callable[[], int] = time.time_ns, monotonic: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self._monotonic = monotonic
        self._began = wall() - monotonic()

    def now(self) -> int:
        """Never earlier than it was before, whatever is done to the wall clock."""
        return self._began + self._monotonic()
