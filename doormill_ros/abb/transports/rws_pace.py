"""How many requests a controller is asked within a second."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

#: RobotWare 6 was seen to answer about 20 requests a second and 503 beyond; version 2.0 gives no figure.
MOST = 20
SPAN = 1.0  # s


class RequestPace:
    """Lets requests pass that are sent one after the other, each answered before the next.

    Counted from the answers on, so that the controller too sees no more than `MOST` of them within `SPAN`, however
    long they were on their way.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, sleep: Callable[[float], None] = time.sleep
    ) -> None:
        """Begin with nothing sent."""
        self._clock = clock
        self._sleep = sleep
        self._answered: deque[float] = deque(maxlen=MOST)

    def wait(self, requests: int = 1) -> None:
        """Sleep until so many may be sent, at most `MOST`."""
        before = len(self._answered) - (MOST - requests) - 1
        if before >= 0:
            pause = self._answered[before] + SPAN - self._clock()
            if pause > 0.0:
                self._sleep(pause)

    def answered(self, requests: int = 1) -> None:
        """So many were answered, or given up."""
        self._answered.extend([self._clock()] * requests)
