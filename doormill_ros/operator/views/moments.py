"""Moments that others tell by the wall clock, kept by the steady one, which nobody sets."""

from __future__ import annotations

import time


def steady(since: float) -> float | None:
    """A time of the wall clock [s since the epoch] by the steady one; None for 0, which tells none."""
    return time.monotonic() - max(time.time() - since, 0.0) if since > 0.0 else None


def age(since: float | None) -> float | None:
    """How long ago a moment of the steady clock was [s]; None where there is none."""
    return None if since is None else time.monotonic() - since
