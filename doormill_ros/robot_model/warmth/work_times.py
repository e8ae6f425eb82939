"""When a cell worked, by the moments at which it milled doors, and how warm it is by that."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np

from doormill_ros.units import hours_to_s

KEPT = 5000  #: last moments that are kept: ten days of 500 doors, after which no arm remembers


class WorkTimes:
    """Moments at which doors were begun.

    An arm is heated from each door to the next one, yet no longer than doors took in the work that told the law;
    whatever is beyond that is a pause. In all other time all but 1 / e of its warmth goes in the time constant in which
    it comes: an arm that stands gives its heat to the air no faster than one that moves through it. Work that nobody
    saw heated nothing. All this errs to the cold: of the growth of an arm that is warmer than it seems too little is
    undone, never too much.
    """

    def __init__(self, moments: Iterable[float] = ()) -> None:
        """Take moments in a row [s since the epoch]."""
        self._moments: deque[float] = deque(maxlen=KEPT)
        for moment in moments:
            self.worked(moment)

    @property
    def doors(self) -> int:
        """How many are known."""
        return len(self._moments)

    def worked(self, moment: float) -> None:
        """A door is begun now [s since the epoch]; a clock that was set back makes what was before unknown."""
        if self._moments and moment < self._moments[-1]:
            self._moments.clear()
        self._moments.append(moment)

    def warmth(self, moment: float, hours: float, takt: float) -> float:
        """Share of the growth in the end that is there, 0..1.

        Args:
            moment: When [s since the epoch]; before the last door nothing is known.
            hours: Time constant [h].
            takt: Longest time from door to door that is work [s].
        """
        if not self._moments or moment < self._moments[-1]:
            return 0.0
        begin = np.array(self._moments)
        end = np.minimum(np.append(begin[1:], moment), begin + takt)
        constant = hours_to_s(hours)
        # The law is linear: each spell of work leaves what has come in it, less what has gone since.
        return float(np.sum(np.exp((end - moment) / constant) - np.exp((begin - moment) / constant)))
