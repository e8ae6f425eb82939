"""Pages of other sites order nothing and read nothing with the operator's browser."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from doormill_ros.operator.access.origin import is_own

FOREIGN = [
    "null",
    "",
    "http://attacker.example",
    "http://127.0.0.1",
    "http://127.0.0.1:1",
    "file://",
    "http://[",
]


@pytest.mark.parametrize("origin", FOREIGN)
@pytest.mark.parametrize(
    ("method", "path"), [("POST", "control/mill"), ("POST", "control/cancel"), ("GET", "control")]
)
def test_an_order_of_a_foreign_page_is_refused_with_the_right_token_too(
    guarded: Any, origin: str, method: str, path: str
) -> None:
    body = {"door_id": "oak"} if path.endswith("mill") else {}
    answer = guarded.order(guarded.keys.operate, path, method, json=body, headers={"Origin": origin})
    assert answer.status_code == 403
    assert repr(origin) in answer.json()["detail"]
    assert "open that page" in answer.json()["detail"]
    assert guarded.control.orders == []


def test_one_foreign_origin_among_two_is_enough(guarded: Any) -> None:
    own = ("Origin", guarded.url.rstrip("/"))
    key = ("Authorization", f"Bearer {guarded.keys.operate}")
    both = httpx.post(guarded.url + "control/cancel", headers=[own, ("Origin", "http://a.example"), key])
    assert (both.status_code, guarded.control.orders) == (403, [])
    assert httpx.post(guarded.url + "control/cancel", headers=[own, key]).status_code == 202


def test_a_foreign_page_reads_nothing_and_upgrades_nothing(guarded: Any) -> None:
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
    }
    for headers in ({}, upgrade):
        for path in ("state", "events", "control/mill"):
            answer = httpx.get(guarded.url + path, headers={"Origin": "http://a.example", **headers})
            assert answer.status_code == 403
    assert httpx.get(guarded.url + "state", headers={"Origin": guarded.url.rstrip("/")}).status_code == 200


@pytest.mark.parametrize(
    ("origin", "host", "expected"),
    [
        ("http://cell:8080", "cell:8080", True),
        ("http://CELL:8080", "cell:8080", True),
        ("http://cell", "cell:80", True),
        ("https://cell", "cell", True),
        ("http://[::1]:8080", "[::1]:8080", True),
        ("https://cell:80", "cell", False),
        ("http://cell:8081", "cell:8080", False),
        ("http://cell.attacker.example:8080", "cell:8080", False),
        ("http://cell:8080@attacker.example", "cell:8080", False),
        ("http://user@cell:8080", "cell:8080", False),
        ("http://cell:8080/", "cell:8080", False),
        ("ftp://cell:8080", "cell:8080", False),
        ("http://cell:x", "cell:8080", False),
        ("http://", "", False),
        ("null", "null", False),
    ],
)
def test_what_counts_as_the_page_itself(origin: str, host: str, expected: bool) -> None:
    assert is_own(origin, host) is expected
