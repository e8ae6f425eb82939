"""Waiting ends with the value, or with the limit."""

from __future__ import annotations

import itertools
import threading

import pytest

from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.cell.run.waiting import wait, wait_until


class Clock:
    """Moves on by a second whenever it is looked at."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        self.now += 1.0
        return self.now


def test_the_first_true_value_is_the_answer() -> None:
    values = iter(["", "", "here", "later"])
    assert wait_until(threading.Condition(), lambda: next(values), 100.0, "nothing came", Clock()) == "here"
    assert next(values) == "later"


def test_what_is_there_is_taken_without_a_limit() -> None:
    assert wait(threading.Condition(), lambda: 3, 0.0) == 3


def test_a_look_that_finds_nothing_ends_with_what_it_found_last() -> None:
    looks = itertools.count()
    assert wait(threading.Condition(), lambda: next(looks) and None, 3.5, Clock()) is None
    assert next(looks) == 4  # after 0, 1, 2 and 3 s


def test_the_error_tells_what_is_missing_and_how_long_it_was_waited_for() -> None:
    with pytest.raises(StageTimeoutError, match=r"^no answer; ask again \(waited 2\.5 s\)$") as caught:
        wait_until(threading.Condition(), lambda: None, 2.5, "no answer; ask again", Clock())
    assert caught.value.data == {"limit": 2.5}


def test_a_notified_condition_is_looked_at_under_its_lock() -> None:
    changed, heard = threading.Condition(), []
    looked = threading.Event()

    def look() -> list[int]:
        looked.set()
        return list(heard)

    def tell() -> None:
        looked.wait()
        with changed:  # not before the waiting thread has let go
            heard.extend([1, 2])
            changed.notify_all()

    thread = threading.Thread(target=tell)
    thread.start()
    assert wait_until(changed, look, 60.0, "nothing came") == [1, 2]
    thread.join()
