"""A pause that is held lasts as long as the first one, and later ones grow from where they were."""

from __future__ import annotations

from doormill_ros.abb.backoff import Backoff


def test_a_held_pause_is_the_first_one_and_makes_none_longer() -> None:
    now = 0.0
    backoff = Backoff(lambda: now, 1.0, 3.0)
    assert backoff.due
    backoff.hold()
    assert not backoff.due
    now = 1.0
    assert backoff.due
    assert [backoff.failed() for _ in range(4)] == [1.0, 2.0, 3.0, 3.0]
    assert not backoff.due
    backoff.reset()
    assert backoff.due
