"""A run hears of its stages once, of the present request only, and one run is in hand at a time."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from doormill_ros.cell.errors import CellBusyError, RunCanceledError, StageRefusedError, StageTimeoutError
from doormill_ros.cell.run.clock import Clock
from doormill_ros.cell.run.run import REMEMBERED, Run, RunDesk, new_run_id


@dataclass
class Answer:
    """What a stage says."""

    accepted: bool = True
    error_code: int = 0
    reason: str = ""


@pytest.fixture
def run() -> Run:
    seconds = iter(range(10_000))
    run = Run("r1", "door", Clock(monotonic=lambda: float(next(seconds)), wall=lambda: 5000.0))
    run.not_before = 4000.0
    return run


def test_the_first_answer_of_a_stage_counts(run: Run) -> None:
    first, second = Answer(), Answer()
    run.deliver("localization", first, 4500.0)
    run.deliver("localization", second, 4600.0)
    assert run.wait_for("localization", 1.0, "none") is first
    assert (run.times, run.pictured) == ({"localization": 5000.0}, {"localization": 4500.0})


def test_what_comes_of_an_earlier_picture_does_not_count(run: Run) -> None:
    run.deliver("localization", Answer(), 3999.9)
    with pytest.raises(StageTimeoutError, match="no targets"):
        run.wait_for("localization", 1.0, "no targets")


def test_before_the_request_no_picture_counts() -> None:
    run = Run("r1", "door", Clock(monotonic=iter(range(100)).__next__))
    run.deliver("localization", Answer(), 9e9)
    with pytest.raises(StageTimeoutError):
        run.wait_for("localization", 1.0, "no targets")


def test_a_refusal_is_raised_with_its_own_code_and_words(run: Run) -> None:
    run.deliver("localization", Answer(False, 204, "the door stands 13 mm off"), 4500.0)
    with pytest.raises(StageRefusedError, match="13 mm") as caught:
        run.wait_for("localization", 1.0, "none")
    assert caught.value.stage_code == 204


def test_an_answer_to_what_is_over_is_no_answer(run: Run) -> None:
    run.deliver("localization", Answer(False, 204, "refused"), 4500.0)
    assert run.wait_for("localization", 1.0, "none", lambda: True) is None


def test_a_run_starts_over_with_what_it_forgot(run: Run) -> None:
    run.deliver("localization", Answer(), 4500.0)
    run.forget()
    run.deliver("localization", Answer(), 4600.0)  # still of the request before
    run.not_before = 4700.0
    second = Answer()
    run.deliver("localization", second, 4800.0)
    assert run.wait_for("localization", 1.0, "none") is second


def test_a_canceled_run_ends_at_its_next_wait_unless_that_has_its_answer(run: Run) -> None:
    run.deliver("localization", Answer(), 4500.0)
    run.cancel()
    assert run.wait_for("localization", 1.0, "none") is not None
    with pytest.raises(RunCanceledError):
        run.wait_for("targets", 1000.0, "none")


def test_no_two_runs_share_a_name() -> None:
    names = [new_run_id() for _ in range(100)]
    assert names == sorted(names)
    assert len(names) == 100


def test_a_second_door_is_refused_while_one_is_in_hand() -> None:
    desk = RunDesk()
    first = desk.begin("first")
    with pytest.raises(CellBusyError, match="door second was refused: first is being milled"):
        desk.begin("second")
    desk.end()
    assert desk.begin("second").run_id != first.run_id


def test_answers_reach_the_run_they_belong_to() -> None:
    desk = RunDesk()
    assert not desk.deliver("localization", "r1", Answer(), 1.0)
    run = desk.begin("door")
    run.not_before = 0.0
    assert not desk.deliver("localization", "another", Answer(), 1.0)
    assert run.times == {}
    assert desk.deliver("localization", run.run_id, Answer(), 1.0)
    assert set(run.times) == {"localization"}


def test_a_late_answer_of_an_ended_run_is_nobody_else_s() -> None:
    desk = RunDesk()
    ended = []
    for _ in range(REMEMBERED + 1):
        ended.append(desk.begin("door").run_id)
        desk.end()
    known = [desk.deliver("localization", run_id, Answer(), 1.0) for run_id in ended]
    assert known == [False] + [True] * REMEMBERED


def test_the_run_in_hand_can_be_canceled_and_none_need_be() -> None:
    desk = RunDesk()
    desk.cancel()
    desk.notify()
    run = desk.begin("door")
    desk.cancel()
    with pytest.raises(RunCanceledError):
        run.wait_for("targets", 1000.0, "none")


def test_a_wait_in_vain_says_that_the_clock_was_set_and_its_owner_hears_of_it() -> None:
    shift, told, now = [0.0], [], [0.0]

    def monotonic() -> float:
        now[0] += 0.01
        return now[0]

    run = Run("r1", "door", Clock(monotonic, lambda: 5000.0 + now[0] + shift[0], told.append))
    with pytest.raises(StageTimeoutError) as caught:
        run.wait_until(lambda: None, 1.0, "nobody came")
    assert caught.value.message == "nobody came (waited 1 s)"
    shift[0] = -3600.0
    with pytest.raises(
        StageTimeoutError, match=r"nobody came .*; the clock was set back by 3600\.0 s in the run"
    ):
        run.wait_until(lambda: None, 1.0, "nobody came")
    assert told == run.steps == [pytest.approx(-3600.0, abs=0.1)]
