"""What is looked at while the robot reads the file, and how often."""

from __future__ import annotations

import pytest

from doormill_ros.abb.handshake.announced import AnnouncedWatch
from doormill_ros.abb.handshake.state import HandshakeTimeouts
from doormill_ros.abb.link_errors import AcknowledgeTimeoutError, RequestWithdrawnError

LIMITS = HandshakeTimeouts(acknowledge=3.0, watch=0.5)


class Hand:
    """Counts how often the signals were looked at, and holds the clock."""

    now = 100.0
    looks = 0

    def require_announced(self) -> None:
        self.looks += 1


@pytest.fixture
def hand() -> Hand:
    return Hand()


@pytest.fixture
def watch(hand: Hand) -> AnnouncedWatch:
    watch = AnnouncedWatch(hand, lambda: hand.now, LIMITS)  # type: ignore[arg-type]
    watch.begin()
    return watch


def test_the_signals_are_looked_at_once_in_each_interval(hand: Hand, watch: AnnouncedWatch) -> None:
    looks = []
    for step in range(1, 17):  # eighths of a second, exact as binary numbers
        hand.now = 100.0 + step / 8
        watch.require(reported=True)
        looks.append(hand.looks)
    assert looks == [0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4]


def test_a_request_that_fell_in_between_is_another_one(watch: AnnouncedWatch) -> None:
    with pytest.raises(RequestWithdrawnError):
        watch.require(reported=False)


def test_the_robot_has_as_long_as_the_limit_says_after_each_announcement(
    hand: Hand, watch: AnnouncedWatch
) -> None:
    hand.now = 102.875
    watch.require(reported=True)
    hand.now = 103.0
    with pytest.raises(AcknowledgeTimeoutError):
        watch.require(reported=True)
    watch.begin()
    hand.now = 105.875
    watch.require(reported=True)
