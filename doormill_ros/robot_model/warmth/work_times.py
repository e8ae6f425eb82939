"""Since when a cell works, by the moments at which it mills doors, and how warm it is by that."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from doormill_ros.units import hours_to_s

#: Between doors that count as one spell of work [s]: five doors of a cell that mills 500 a day. In the doors that tell
#: a law shorter waits are part of the work, so they are part of it here.
PAUSE = 900.0


class WorkTimes:
    """Moments of work as spells; the time of no spell is a pause.

    In a spell all but 1 / e of what is missing comes in the time constant of the law. In a pause all but 1 / e of it
    goes in that time: an arm that stands gives its heat to the air no faster than one that moves through it, so it is
    at least as warm as that. A cell of which nobody saw the work counts as cold. Both err to the cold: of the growth of
    an arm that is warmer than it seems too little is undone, never too much.
    """

    def __init__(self, moments: Iterable[float] = ()) -> None:
        """Take moments in a row [s since the epoch]."""
        self._spells: list[tuple[float, float]] = []
        for moment in moments:
            self.worked(moment)

    @classmethod
    def through(cls, begin: float, end: float) -> WorkTimes:
        """Work without a pause [s since the epoch], for who knows some of its doors only."""
        work = cls()
        work._spells = [(begin, end)]
        return work

    @property
    def since(self) -> float | None:
        """When the spell in hand began [s since the epoch]; None before the first."""
        return self._spells[-1][0] if self._spells else None

    def worked(self, moment: float) -> None:
        """A door is milled now [s since the epoch]; a clock that was set back makes what was before unknown."""
        if self._spells and moment < self._spells[-1][1]:
            self._spells.clear()
        if self._spells and moment - self._spells[-1][1] <= PAUSE:
            self._spells[-1] = self._spells[-1][0], moment
        else:
            self._spells.append((moment, moment))

    def warmth(self, moment: float, hours: float) -> float:
        """Share of the growth in the end that is there, 0..1.

        Args:
            moment: When [s since the epoch]; before the last door nothing is known.
            hours: Time constant [h].
        """
        missing, end = 1.0, None
        for begin, last in self._spells:
            if end is not None:
                missing = 1.0 - (1.0 - missing) * _left(begin - end, hours)
            missing *= _left(last - begin, hours)
            end = last
        if end is None or moment < end:
            return 0.0
        waited = moment - end
        if waited <= PAUSE:
            return 1.0 - missing * _left(waited, hours)
        return (1.0 - missing) * _left(waited, hours)


def _left(seconds: float, hours: float) -> float:
    return float(np.exp(-max(seconds, 0.0) / hours_to_s(hours)))
