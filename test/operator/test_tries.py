"""Who guesses tokens waits longer and longer; nobody else does."""

from __future__ import annotations

from typing import Any

import pytest

from doormill_ros.operator.access.tries import CLIENTS, FORGOTTEN, FREE, LONGEST_WAIT, Tries


def test_a_guesser_is_locked_out_and_the_right_token_does_not_open_before_its_time(guarded: Any) -> None:
    for _ in range(FREE):
        assert guarded.order("wrong").status_code == 401
    locked = guarded.order(guarded.keys.operate)
    assert locked.status_code == 429
    assert locked.headers["retry-after"] == "1"
    assert "wait 1 s" in locked.json()["detail"]
    assert guarded.control.orders == []
    guarded.now[0] = 1.0
    assert guarded.order(guarded.keys.operate).status_code == 202
    # The right token forgives nothing: the next wrong one doubles the wait.
    assert guarded.order("wrong").status_code == 401
    assert guarded.order(guarded.keys.operate).headers["retry-after"] == "2"


def test_a_client_cannot_call_itself_another(guarded: Any) -> None:
    answers = [
        guarded.order("wrong", headers={"X-Forwarded-For": f"10.0.0.{n}", "Forwarded": f"for=10.0.0.{n}"})
        for n in range(FREE + 1)
    ]
    assert [answer.status_code for answer in answers] == [401] * FREE + [429]


def test_an_order_without_any_token_is_no_guess(guarded: Any) -> None:
    for _ in range(FREE + 1):
        assert guarded.order(None).status_code == 401
    assert guarded.order(guarded.keys.operate).status_code == 202


def test_every_order_counts_and_looking_goes_on(guarded: Any) -> None:
    orders = [
        ("GET", "control"),
        ("POST", "control/mill"),
        ("GET", "control/audit"),
        ("POST", "control/cancel"),
    ]
    for number in range(FREE):
        method, path = orders[number % len(orders)]
        assert guarded.order(f"wrong {number}", path, method).status_code == 401
    for method, path in orders:
        assert guarded.order(guarded.keys.engineer, path, method).status_code == 429
    assert guarded.order(None, "state", "GET").status_code == 200


def test_the_wait_doubles_up_to_its_limit_and_is_forgotten() -> None:
    now = [1000.0]
    tries, waits = Tries(lambda: now[0]), []
    for _ in range(FREE + 12):
        tries.failed("10.0.0.1")
        waits.append(tries.wait("10.0.0.1"))
        now[0] += waits[-1]
        assert tries.wait("10.0.0.1") == 0.0
    assert waits[: FREE - 1] == [0.0] * (FREE - 1)
    assert waits[FREE - 1 : FREE + 8] == [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0]
    assert waits[FREE + 8 :] == [LONGEST_WAIT] * 4
    now[0] += FORGOTTEN
    tries.failed("10.0.0.1")
    assert tries.wait("10.0.0.1") == 0.0


@pytest.mark.parametrize(
    ("guesser", "other", "same"),
    [
        ("10.0.0.1", "10.0.0.2", False),
        ("10.0.0.1", "::ffff:10.0.0.1", True),
        ("2001:db8:1:2::3", "2001:db8:1:2:ffff::9", True),
        ("2001:db8:1:2::3", "2001:db8:1:3::3", False),
        ("", "cell", False),
    ],
)
def test_clients_are_told_apart(guesser: str, other: str, same: bool) -> None:
    tries = Tries(lambda: 0.0)
    for _ in range(FREE):
        tries.failed(guesser)
    assert (tries.wait(other) > 0.0) is same


def test_many_clients_cost_no_memory_and_free_no_guesser_that_goes_on() -> None:
    tries = Tries(lambda: 0.0)
    for number in range(3 * CLIENTS):
        tries.failed(f"10.{number >> 16}.{number >> 8 & 255}.{number & 255}")
        if number % 100 == 0:
            tries.failed("192.168.0.1")
    assert len(tries._wrong) == CLIENTS
    assert tries.wait("192.168.0.1") > 0.0
