"""Who has no token makes the page read nothing, and who has one no more than an order."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from typing import Any

import pytest
from fastapi.routing import APIRoute

from doormill_ros.operator.access.short_body import LARGEST_BODY
from doormill_ros.operator.access.token import Keys, Role, new_token
from doormill_ros.operator.access.tries import FREE
from doormill_ros.operator.orders.orders import ROLES, ModelOrderRequest
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore

KEYS = Keys(new_token(), new_token())
BROKEN = b'{"door_id": '


def ask(
    app: Any, path: str, token: str | None, chunks: list[bytes], told: bool = False
) -> tuple[int, str, int]:
    """Status and text of the answer to an order, and how many chunks of its body were read."""
    headers = [(b"host", b"127.0.0.1"), (b"content-type", b"application/json")]
    headers += [(b"authorization", f"Bearer {token}".encode())] if token else []
    headers += [(b"content-length", str(sum(map(len, chunks))).encode())] if told else []
    scope = {
        "type": "http",
        "method": "POST",
        "path": path,
        "query_string": b"",
        "headers": headers,
        "client": ("10.0.0.1", 1),
        "server": ("127.0.0.1", 80),
        "scheme": "http",
    }
    sent: list[dict[str, Any]] = []
    left = list(chunks)

    async def receive() -> dict[str, Any]:
        body = left.pop(0)
        return {"type": "http.request", "body": body, "more_body": bool(left)}

    async def send(message: dict[str, Any]) -> None:
        sent.append(message)

    asyncio.run(app(scope, receive, send))
    text = b"".join(message.get("body", b"") for message in sent).decode()
    return sent[0]["status"], text, len(chunks) - len(left)


@pytest.fixture
def make(guarded: Any) -> Callable[[], Any]:
    return lambda: create_app(ViewStore(), guarded.control, KEYS, clock=lambda: 0.0)


@pytest.mark.parametrize("path", sorted(ROLES))
@pytest.mark.parametrize("told", [False, True])
def test_of_an_order_that_nobody_may_give_nothing_is_read(
    make: Callable[[], Any], path: str, told: bool
) -> None:
    app = make()
    for token in (None, *(f"wrong {number}" for number in range(FREE))):
        status, _, read = ask(app, path, token, [BROKEN] * 1000, told)
        assert (status, read) == (401, 0)
    status, _, read = ask(app, path, KEYS.engineer, [BROKEN] * 1000, told)
    assert (status, read) == (429, 0)
    if ROLES[path] is Role.ENGINEER:
        status, _, read = ask(make(), path, KEYS.operate, [BROKEN] * 1000, told)
        assert (status, read) == (403, 0)


@pytest.mark.parametrize("path", ["/control/mill", "/control/cancel", "/control/accept", "/control/none"])
def test_an_order_that_is_too_long_is_refused_before_it_is_read(make: Callable[[], Any], path: str) -> None:
    chunks = [b"0" * 1000] * 1000
    for told, expected in ((True, 0), (False, LARGEST_BODY // 1000 + 1)):
        status, text, read = ask(make(), path, KEYS.engineer, chunks, told)
        assert (status, read) == (413, expected)
        assert f"more than {LARGEST_BODY} bytes" in json.loads(text)["detail"]


def test_broken_orders_are_told_so_only_to_who_may_order(make: Callable[[], Any]) -> None:
    assert ask(make(), "/control/mill", KEYS.operate, [BROKEN])[0] == 422
    assert ask(make(), "/control/mill", "wrong", [BROKEN])[0] == 401


def test_the_longest_order_passes_in_pieces_too(guarded: Any, make: Callable[[], Any]) -> None:
    longest = {
        name: max(rule.max_length for rule in field.metadata if hasattr(rule, "max_length"))
        for name, field in ModelOrderRequest.model_fields.items()
        if name != "version"
    }
    # Letters beyond the first plane take the most bytes when they are escaped.
    order = {"version": 2**32 - 1, **{name: "\U00010400" * length for name, length in longest.items()}}
    body = json.dumps(order).encode()
    pieces = [body[start : start + 1000] for start in range(0, len(body), 1000)]
    assert ask(make(), "/control/accept", KEYS.engineer, pieces)[0] == 200
    assert guarded.control.orders == [f"accept {2**32 - 1}, {order['who']}: {order['why']}"]


def test_over_http_a_long_order_is_refused_in_one_piece_and_in_many(guarded: Any) -> None:
    for content in (b"0" * 100_000, (b"0" * 1000 for _ in range(100))):
        assert guarded.order(guarded.keys.operate, content=content).status_code == 413
    assert guarded.order("wrong", content=b"0" * 100_000).status_code == 401
    assert guarded.control.orders == []


def test_every_order_has_its_role_and_a_path_that_is_none_needs_the_highest(make: Callable[[], Any]) -> None:
    served = {
        route.path
        for route in make().routes
        if isinstance(route, APIRoute) and route.path.startswith("/control")
    }
    assert served == set(ROLES)
    for path in ("/control/none", "/control/mill\n", "/control/accept\n", "/control/"):
        assert ask(make(), path, None, [b""])[0] == 401
        assert ask(make(), path, KEYS.operate, [b""])[0] == 403


def test_a_line_end_behind_the_path_goes_round_nothing(make: Callable[[], Any]) -> None:
    assert ask(make(), "/control\n", None, [b""])[0] == 401
