"""Times that tell what came after what."""

from __future__ import annotations

from collections.abc import Sequence

APART = 1e-3  #: by which what has one stamp follows each other [s]


def growing(times: Sequence[float]) -> list[float]:
    """Times that grow from each to the next, changed where they do not [s]."""
    found = list(times[:1])
    for time in times[1:]:
        found.append(max(time, found[-1] + APART))
    return found
