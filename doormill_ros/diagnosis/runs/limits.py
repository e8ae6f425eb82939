"""How many runs are questioned and how few tell nothing; without numpy, for who only asks."""

from __future__ import annotations

FEWEST = 6  #: runs from which on anything is called a change
MOST = 200  #: runs that are questioned; the last ones of more


def fewest(runs: int) -> int:
    """How many of some runs have to tell a figure for it to be asked."""
    return min(FEWEST, runs)
