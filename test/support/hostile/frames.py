"""A controller's event stream, byte by byte (RFC 6455): a server that upgrades and then sends whatever it was given.

And what our side hears of it.
"""

from __future__ import annotations

import base64
import hashlib
import logging
import socket
import struct
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import TracebackType

import httpx

from doormill_ros.abb.transports import rws_events
from doormill_ros.abb.transports.rws_dialect import RWS1
from doormill_ros.abb.transports.rws_events import RwsEvents
from support.waiting import LIMIT

_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # RFC 6455, 1.3
TEXT, BINARY, CLOSE, PING = 0x1, 0x2, 0x8, 0x9
EVENT = "".join(
    f'<li class="ios-signalstate-ev"><a href="/rw/iosystem/signals/diRequest;state" rel="self"/>\n'
    f'<span class="lvalue">{level}</span></li>\n'
    for level in (1, 0, 1)
)
#: Levels of the stream that comes last.
_LAST = [True, True, False, False, True, True]


def frame(
    payload: bytes, opcode: int = TEXT, final: bool = True, reserved: int = 0, length: int = -1
) -> bytes:
    """One frame of a server; `length`: what it says of itself, -1 for the truth, `reserved`: the three bits."""
    said = len(payload) if length < 0 else length
    first = (0x80 if final else 0) | (reserved << 4) | opcode
    if said < 126:
        return bytes([first, said]) + payload
    if said < 1 << 16:
        return struct.pack("!BBH", first, 126, said) + payload
    return struct.pack("!BBQ", first, 127, said) + payload


class FrameServer:
    """Upgrades each connection and sends it the next of some streams of bytes, then ends it.

    After the last one it keeps the connection open and sends nothing more.
    """

    def __init__(self, streams: Sequence[bytes]) -> None:
        self._streams = list(streams)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self.connections = 0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self) -> FrameServer:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._ended.set()
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self._thread.join()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            with connection:
                connection.settimeout(LIMIT)
                self._upgrade(connection)
                number, self.connections = self.connections, self.connections + 1
                try:
                    connection.sendall(self._streams[min(number, len(self._streams) - 1)])
                except OSError:  # it was hung up on in the middle
                    continue
                if number >= len(self._streams) - 1:
                    self._ended.wait()

    @staticmethod
    def _upgrade(connection: socket.socket) -> None:
        asked = b""
        while b"\r\n\r\n" not in asked:
            asked += connection.recv(4096)
        headers = dict(line.split(b": ", 1) for line in asked.split(b"\r\n")[1:] if b": " in line)
        named = {name.lower(): value for name, value in headers.items()}
        accept = base64.b64encode(hashlib.sha1(named[b"sec-websocket-key"] + _GUID).digest())
        connection.sendall(
            b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Accept: "
            + accept
            + b"\r\nSec-WebSocket-Protocol: "
            + named[b"sec-websocket-protocol"]
            + b"\r\n\r\n"
        )


class _Session:
    """Stands for the session with a controller whose subscriptions lead to a server of frames."""

    def __init__(self, address: str) -> None:
        self.url, self.tls = f"http://{address}", None

    def cookie_header(self) -> str:
        return "a=b"

    def request(self, method: str, path: str, **_: object) -> httpx.Response:
        return httpx.Response(201, headers={"Location": f"ws://controller/poll/{path.strip('/')[:3]}1"})


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """What the event stream warns of, also where nobody wants to hear it."""
    told: list[str] = []

    class Handler(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            told.append(record.getMessage())

    handler, disabled = Handler(logging.WARNING), logging.root.manager.disable
    rws_events._LOG.addHandler(handler)
    logging.disable(logging.NOTSET)
    try:
        yield told
    finally:
        logging.disable(disabled)
        rws_events._LOG.removeHandler(handler)


def heard(streams: Sequence[bytes]) -> tuple[list[bool], list[str]]:
    """The edges that come of some streams, one after the other, and what was warned of; a good one ends them."""
    item = EVENT.split("</li>")[0] + "</li>"
    last = "".join(item.replace(">1<", f">{level:d}<") for level in _LAST).encode()
    edges: list[bool] = []
    with _warnings() as told, FrameServer([*streams, frame(last)]) as server:
        events = RwsEvents(_Session(server.address), RWS1, "diRequest", threading.Event())  # type: ignore[arg-type]
        events.start()
        deadline = time.monotonic() + LIMIT
        while server.connections <= len(streams) or edges[-len(_LAST) :] != _LAST:
            if not events._thread.is_alive():
                raise AssertionError(f"nobody listens any more: {told}")
            if time.monotonic() > deadline:
                raise AssertionError(f"the last stream is not heard: {edges}, {told}")
            edge = events.next_edge()
            if edge is None:
                time.sleep(0.005)
            else:
                edges.append(edge)
        events.close()
        if events._thread.is_alive():
            raise AssertionError("it does not end")
    return edges[: -len(_LAST)], told
