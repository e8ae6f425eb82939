"""Wait for what other threads bring about."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TypeVar

from doormill_ros.cell.errors import StageTimeoutError

LOOK_AGAIN = 0.05  # s, for conditions of which nobody tells

Value = TypeVar("Value")


def wait(
    changed: threading.Condition,
    look: Callable[[], Value | None],
    limit: float,
    clock: Callable[[], float] = time.monotonic,
) -> Value | None:
    """The first true value of `look`, its last false one when the limit is over.

    Args:
        changed: Held while `look` is called; to be notified when it may have become true.
        look: Looked at whenever `changed` was notified, at least every 50 ms.
        limit: Longest wait [s].
        clock: Monotonic [s].
    """
    deadline = clock() + limit
    with changed:
        while not (value := look()):
            left = deadline - clock()
            if left <= 0.0:
                break
            changed.wait(min(left, LOOK_AGAIN))
        return value


def wait_until(
    changed: threading.Condition,
    look: Callable[[], Value | None],
    limit: float,
    otherwise: str,
    clock: Callable[[], float] = time.monotonic,
) -> Value:
    """The first true value of `look`; see `wait`.

    Args:
        changed: As for `wait`.
        look: As for `wait`.
        limit: Longest wait [s].
        otherwise: What went missing and what to do, for the error.
        clock: Monotonic [s].

    Raises:
        StageTimeoutError: Nothing within the limit.
    """
    value = wait(changed, look, limit, clock)
    if not value:
        raise StageTimeoutError(f"{otherwise} (waited {limit:g} s)", limit=limit)
    return value
