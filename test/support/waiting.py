"""Wait for what other threads bring about."""

from __future__ import annotations

import time
from collections.abc import Callable

LIMIT = 600.0  #: longer than a loaded machine takes for anything that is waited for, less than a test is given [s]
LOOK_AGAIN = 0.005  # s


def until(condition: Callable[[], object], told: Callable[[], object] = lambda: "did not happen") -> None:
    """Return once a condition holds; a test fails with what is told when it does not within the limit."""
    deadline = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < deadline, told()
        time.sleep(LOOK_AGAIN)
