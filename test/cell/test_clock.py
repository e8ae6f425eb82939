"""A clock that was set is told from one that runs fast, from a process that was kept waiting and from noise."""

from __future__ import annotations

import pytest

from doormill_ros.cell.run.clock import FASTEST, Clock, ClockWatch, EvenClock, step_text

EPOCH, HOUR = 1.8e9, 3600.0


class Hands:
    """Both clocks of a machine.

    Attributes:
        rate: By how much the wall clock goes on a second.
        stalls: So long the process is kept waiting after each of the next readings [s].
    """

    def __init__(self) -> None:
        self.at, self.shift, self.rate = 50.0, EPOCH, 1.0
        self.stalls: list[float] = []
        self.watch = ClockWatch(Clock(self.monotonic, self.wall))

    def monotonic(self) -> float:
        return self._kept(self.at)

    def wall(self) -> float:
        return self._kept(self.shift + self.rate * self.at)

    def _kept(self, value: float) -> float:
        self.at += self.stalls.pop(0) if self.stalls else 0.0
        return value


@pytest.mark.parametrize("step", [HOUR, -HOUR, 5.0, -5.0])
def test_a_step_is_seen_once_and_with_its_size(step: float) -> None:
    hands = Hands()
    for number in range(10):
        hands.at += 0.05
        hands.shift += step if number == 4 else 0.0
        assert hands.watch.now() == hands.at
        assert len(hands.watch.steps) == (number >= 4)
    assert hands.watch.steps == [pytest.approx(step, abs=1e-3)]


def test_a_step_between_two_readings_is_seen_the_next_time() -> None:
    told = iter([EPOCH, EPOCH, EPOCH, EPOCH - HOUR, EPOCH - HOUR, EPOCH - HOUR])
    watch = ClockWatch(Clock(lambda: 50.0, told.__next__))
    counts = []
    for _ in range(3):
        watch.now()
        counts.append(len(watch.steps))
    assert counts == [0, 0, 1]
    assert watch.steps == [-HOUR]


@pytest.mark.parametrize("rate", [0.0, 0.5, 1.0, 1.001, FASTEST])
@pytest.mark.parametrize("pause", [0.05, 3.0, 100.0])
def test_a_clock_of_another_speed_was_not_set(rate: float, pause: float) -> None:
    hands = Hands()
    hands.rate = rate
    for _ in range(10):
        hands.at += pause
        hands.watch.now()
    assert hands.watch.steps == []


@pytest.mark.parametrize("stall", [0.3, 0.9, 30.0])
@pytest.mark.parametrize("after", range(6))
def test_a_process_that_is_kept_waiting_between_two_readings_sees_no_step(stall: float, after: int) -> None:
    hands = Hands()
    hands.stalls = [0.0] * after + [stall]
    for _ in range(5):
        hands.at += 0.05
        hands.watch.now()
    assert hands.watch.steps == []


def test_a_step_is_said_in_words() -> None:
    assert step_text(HOUR) == "the clock was set forwards by 3600.0 s"
    assert step_text(-1.25) == "the clock was set back by 1.2 s"


def test_an_even_clock_goes_on_whatever_is_done_to_the_other() -> None:
    wall, monotonic = iter([1_000, 9_000, 0]), iter([10, 10, 15, 30])
    clock = EvenClock(wall.__next__, monotonic.__next__)
    assert [clock.now() for _ in range(3)] == [1_000, 1_005, 1_020]
