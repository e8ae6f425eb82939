"""Stamps of messages as numbers."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from doormill_ros.messages.stamps import nanoseconds_of, seconds_of


def test_times_are_exact_to_the_nanosecond() -> None:
    stamp = SimpleNamespace(sec=1_700_000_000, nanosec=123_456_789)
    assert nanoseconds_of(stamp) == 1_700_000_000_123_456_789
    assert seconds_of(stamp) == pytest.approx(1_700_000_000.123456789, abs=1e-6)
