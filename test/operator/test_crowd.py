"""However many look at the page, an order is taken."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from typing import Any

import httpx
import pytest

from doormill_ros.operator.orders.orders import DOORS_AT_ONCE
from doormill_ros.operator.serving import event_streams
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore
from support.waiting import LIMIT

MANY = 60  # more than threads that a web server shares


@pytest.fixture
def silence(guarded: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[threading.Event]:
    """The recipe database answers nobody before this is set."""
    over = threading.Event()

    def doors(prefix: str) -> list[str]:
        over.wait()
        return [prefix]

    monkeypatch.setattr(guarded.control, "doors", doors)
    yield over
    over.set()


def test_a_run_is_canceled_while_many_wait_for_a_silent_database(
    guarded: Any, silence: threading.Event
) -> None:
    with ThreadPoolExecutor(MANY) as pool:
        try:
            url = f"{guarded.url}doors?prefix=oak"
            asked = [pool.submit(httpx.get, url, timeout=3 * LIMIT) for _ in range(MANY)]
            first = as_completed(asked, LIMIT)
            answers = [next(first).result() for _ in range(MANY - DOORS_AT_ONCE)]
            assert {answer.status_code for answer in answers} == {503}
            assert "type the whole id" in answers[0].json()["detail"]
            assert guarded.order(guarded.keys.operate).status_code == 202
            assert guarded.control.orders == ["cancel"]
            assert not silence.is_set()
        finally:
            silence.set()
        assert [future.result().status_code for future in asked].count(200) == DOORS_AT_ONCE
    assert httpx.get(url, timeout=LIMIT).json() == ["oak"]


def test_one_stream_more_than_there_may_be_is_refused_until_another_ends(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    most = 3
    monkeypatch.setattr(event_streams.EventStreams.__init__, "__defaults__", (most,))
    with PageServer(create_app(ViewStore()), "127.0.0.1", 0) as server, ExitStack() as streams:
        url = f"{server.url}events"

        def opened() -> httpx.Response:
            return streams.enter_context(httpx.stream("GET", url, timeout=LIMIT))

        shown = [opened() for _ in range(most)]
        assert [answer.status_code for answer in shown] == [200] * most
        refused = opened()
        assert refused.status_code == 503
        refused.read()
        assert f"{most} browsers show the page already" in refused.json()["detail"]
        assert httpx.get(f"{server.url}state", timeout=LIMIT).status_code == 200
        shown[0].close()
        # The server hears of the end a moment later.
        while (again := opened()).status_code == 503:
            pass
        assert again.status_code == 200
