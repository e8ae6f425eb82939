"""Connections that never ask: they end, and keep nobody from the page."""

from __future__ import annotations

import json
import logging
import socket
import time
from collections.abc import Callable
from contextlib import ExitStack

import httpx
import pytest

from doormill_ros.operator.serving import prompt_protocol
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore
from support.waiting import LIMIT, until

HEAD = b"POST /order HTTP/1.1\r\nHost: localhost\r\n"
PARTS = {
    "nothing": b"",
    "part of a head": HEAD,
    "part of a body": HEAD + b"Content-Type: application/json\r\nContent-Length: 50\r\n\r\n{",
    "part of a second head": b"GET /state HTTP/1.1\r\nHost: localhost\r\n\r\nGET /sta",
}


@pytest.fixture
def connect() -> Callable[[PageServer], socket.socket]:
    with ExitStack() as opened:
        yield lambda server: opened.enter_context(socket.create_connection(("127.0.0.1", server.port), LIMIT))


def ends(connection: socket.socket) -> bool:
    """Read until the other side closes."""
    connection.settimeout(LIMIT)
    try:
        while connection.recv(1 << 16):
            pass
    except ConnectionResetError:
        pass
    return True


def sent(connection: socket.socket, data: bytes) -> bool:
    """False where the other side has closed."""
    try:
        connection.sendall(data)
    except OSError:
        return False
    return True


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS)
def test_who_does_not_go_on_is_left(
    part: bytes, connect: Callable[[PageServer], socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(prompt_protocol, "PATIENCE", 0.5)
    with PageServer(create_app(ViewStore()), "127.0.0.1", 0) as server:
        connection = connect(server)
        connection.sendall(part)
        assert ends(connection)


def test_a_slow_head_is_left_however_its_letters_come(
    connect: Callable[[PageServer], socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(prompt_protocol, "PATIENCE", 0.5)
    with PageServer(create_app(ViewStore()), "127.0.0.1", 0) as server:
        connection, begun = connect(server), time.monotonic()
        while sent(connection, b"G") and time.monotonic() < begun + LIMIT:
            time.sleep(0.05)
        assert time.monotonic() < begun + LIMIT


def test_a_live_stream_outlives_the_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prompt_protocol, "PATIENCE", 0.3)
    store = ViewStore()
    with (
        PageServer(create_app(store), "127.0.0.1", 0) as server,
        httpx.stream("GET", f"{server.url}events", timeout=LIMIT) as stream,
    ):
        assert stream.status_code == 200
        doors = (
            json.loads(line[6:])["door_id"] for line in stream.iter_lines() if line.startswith("data: {")
        )
        assert next(doors) == ""
        time.sleep(4.0 * prompt_protocol.PATIENCE)
        store.update(lambda view: view.with_run("run", "oak"))
        assert next(doors) == "oak"


def test_many_half_open_connections_keep_nobody_from_the_page(
    connect: Callable[[PageServer], socket.socket],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(prompt_protocol, "CONNECTIONS", 20)
    with caplog.at_level(logging.WARNING), PageServer(create_app(ViewStore()), "127.0.0.1", 0) as server:
        many = [connect(server) for _ in range(100)]
        for connection in many:
            sent(connection, HEAD)
        assert httpx.get(f"{server.url}state", timeout=LIMIT).status_code == 200
        assert ends(many[0])
    assert [record.getMessage() for record in caplog.records if "asyncio" in record.name] == []


def test_a_socket_that_takes_nobody_is_told_once(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.ERROR), PageServer(create_app(ViewStore()), "127.0.0.1", 0) as server:
        accept = socket.socket.accept
        refusing = {"left": 200}

        def refused(self: socket.socket):
            if self.getsockname()[1] == server.port and refusing["left"]:
                refusing["left"] -= 1
                raise OSError(24, "Too many open files")
            return accept(self)

        monkeypatch.setattr(socket.socket, "accept", refused)
        with socket.create_connection(("127.0.0.1", server.port), LIMIT):
            until(lambda: refusing["left"] <= 197)  # refused again and again
            refusing["left"] = 0
    told = [record for record in caplog.records if "accept" in record.getMessage()]
    assert len(told) == 1
