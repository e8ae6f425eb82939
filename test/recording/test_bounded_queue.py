"""The queue between receiving and writing: bounded, in order, and honest about what it lost."""

from __future__ import annotations

import threading
from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.recording.bounded_queue import BoundedQueue, Received

LIMIT = 100


def item(topic: str, size: int, number: int = 0) -> Received:
    return Received(topic, bytes(size), number, number)


@given(st.lists(st.one_of(st.none(), st.tuples(st.sampled_from("abc"), st.integers(0, 120))), max_size=60))
def test_everything_is_either_taken_in_order_or_counted(steps: list[tuple[str, int] | None]) -> None:
    queue, waiting, taken, kept, lost = BoundedQueue(LIMIT), 0, [], [], Counter()
    for number, step in enumerate(steps):
        if step is None:
            taken += queue.take(0.0)
            waiting = 0
        elif queue.put(item(*step, number)):
            kept.append(number)
            waiting += step[1]
        else:
            lost[step[0]] += 1
            assert waiting + step[1] > LIMIT
        assert waiting <= LIMIT
    taken += queue.take(0.0)
    assert [t.received_ns for t in taken] == kept
    assert queue.dropped == lost


def test_nothing_is_counted_after_the_end_of_a_recording() -> None:
    queue = BoundedQueue(LIMIT)
    queue.put(item("a", 1))
    queue.close()
    assert not queue.put(item("a", 1))
    assert queue.dropped == {}
    assert not queue.closed
    assert len(queue.take(0.0)) == 1
    assert queue.closed


def test_what_comes_after_the_disk_failed_is_counted() -> None:
    queue = BoundedQueue(LIMIT)
    queue.close(failed=True)
    queue.put(item("a", 1))
    queue.count_dropped({"a": 1, "b": 1})
    assert queue.dropped == {"a": 2, "b": 1}


def test_a_waiting_writer_is_woken() -> None:
    queue, taken = BoundedQueue(LIMIT), []
    thread = threading.Thread(target=lambda: taken.extend(queue.take(30.0)))
    thread.start()
    queue.put(item("a", 1))
    thread.join(10.0)
    assert len(taken) == 1
