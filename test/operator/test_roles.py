"""Look, operate, engineer: who may do what."""

from __future__ import annotations

import hmac
from typing import Any

import pytest

from doormill_ros.operator.access.token import Holder, Keys, Role, new_token

ORDERS = [("POST", "control/mill"), ("POST", "control/cancel"), ("GET", "control"), ("GET", "control/audit")]


@pytest.mark.parametrize(
    ("role", "expected"),
    [
        ("", [401, 401, 401, 401]),
        ("operate", [202, 202, 200, 403]),
        ("engineer", [202, 202, 200, 200]),
    ],
)
def test_what_each_role_may(guarded: Any, role: str, expected: list[int]) -> None:
    token = getattr(guarded.keys, role) if role else None
    answers = [guarded.order(token, path, method, json={"door_id": "oak"}) for method, path in ORDERS]
    assert [answer.status_code for answer in answers] == expected
    assert guarded.control.orders == (["mill oak", "cancel"] if role else [])
    assert guarded.order(token, "state", "GET").status_code == 200


def test_who_may_too_little_is_told_so(guarded: Any) -> None:
    answer = guarded.order(guarded.keys.operate, "control/audit", "GET")
    assert (
        answer.json()["detail"] == "this token allows to operate, the order needs the token of the engineer"
    )


def test_the_engineer_reads_the_newest_entries_first(guarded: Any) -> None:
    guarded.order(guarded.keys.operate, "control/mill", json={"door_id": "oak"})
    guarded.order("wrong")
    entries = guarded.order(guarded.keys.engineer, "control/audit", "GET").json()
    assert sorted((e["role"], e["status"]) for e in entries) == [("look", 401), ("operate", 202)]
    assert [e["time"] for e in entries] == sorted((e["time"] for e in entries), reverse=True)


def test_a_role_without_a_token_is_nobodys() -> None:
    for keys in (Keys(), Keys("", "")):
        assert not keys
        for header in (None, "Bearer", "Bearer ", "Bearer None"):
            assert keys.holder(header) is None
    assert Keys("a", None).holder("Bearer a") == Holder(Role.OPERATE)
    assert Keys(None, "b").holder("Bearer b") == Holder(Role.ENGINEER)


@pytest.mark.parametrize("said", ["first", "second", "wrong", "", "firs", "first "])
def test_a_token_is_compared_in_the_same_time_wherever_it_differs(
    monkeypatch: pytest.MonkeyPatch, said: str
) -> None:
    """Every comparison is that of `hmac`, with both tokens whatever the first gives, and its answer counts."""
    compared: list[tuple[bytes, bytes]] = []

    def compare(left: bytes, right: bytes) -> bool:
        compared.append((left, right))
        return False

    monkeypatch.setattr(hmac, "compare_digest", compare)
    keys = Keys("first", "second", {Holder(Role.OPERATE, "Kari"): "third"})
    assert keys.holder(f"Bearer {said}") is None
    assert compared == [(said.strip().encode(), token) for token in (b"first", b"second", b"third")]


@pytest.mark.parametrize(("number", "role"), [(0, Role.OPERATE), (1, Role.ENGINEER)])
def test_what_the_comparison_says_is_the_role(
    monkeypatch: pytest.MonkeyPatch, number: int, role: Role
) -> None:
    answers = [place == number for place in range(2)]
    monkeypatch.setattr(hmac, "compare_digest", lambda left, right: answers.pop(0))
    assert Keys("first", "second").holder("Bearer neither") == Holder(role)
    assert answers == []


def test_roles_have_tokens_of_their_own_that_no_text_of_them_shows() -> None:
    token = new_token()
    with pytest.raises(ValueError, match="one token"):
        Keys(token, token)
    with pytest.raises(ValueError, match="two people"):
        Keys(None, token, {Holder(Role.OPERATE, "Kari"): token})
    assert token not in repr(Keys(token, None))
