"""How many runs are questioned and how few tell nothing; without numpy, for who only asks."""

from __future__ import annotations

FEWEST = 6  #: runs from which on anything is called a change
MOST = 200  #: runs that are questioned; the last ones of more
