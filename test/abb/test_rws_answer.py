"""Answers without end, or longer than any right one: given up by their size, in one sentence."""

from __future__ import annotations

import socket
import threading
import zlib
from collections.abc import Iterator

import pytest

from doormill_ros.abb.credentials import Credentials
from doormill_ros.abb.link_errors import ControllerReplyError
from doormill_ros.abb.transports.rws_answer import LARGEST
from doormill_ros.abb.transports.rws_http import RwsHttp
from support.waiting import LIMIT
from support.web_services import PATIENT

TOO_MUCH = 600 * 1024 * 1024
BUFFERS = 60 * 1024 * 1024  #: more than two sockets hold between them
PIECE = bytes(64 * 1024)
CHUNK = b"10000\r\n" + PIECE + b"\r\n"
CHALLENGE = b'WWW-Authenticate: Digest realm="x", nonce="1", algorithm=MD5, qop="auth"\r\n'
PACKED = zlib.compress(bytes(8 * LARGEST))


class Sender:
    """Answers every request with one head, and pieces until nobody takes them or it was too much."""

    def __init__(self, head: bytes, piece: bytes) -> None:
        self._head, self._piece = head, piece
        self.sent = 0
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self._socket.getsockname()[1]}"
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                return
            with connection:
                self._answer(connection)

    def _answer(self, connection: socket.socket) -> None:
        try:
            connection.recv(65536)
            connection.sendall(self._head)
            while self.sent < TOO_MUCH:
                connection.sendall(self._piece)
                self.sent += len(self._piece)
        except OSError:
            pass

    def close(self) -> None:
        self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        self._thread.join(LIMIT)


@pytest.fixture(
    params=[
        (b"200 OK\r\nContent-Length: %d\r\n" % TOO_MUCH, PIECE),
        (b"200 OK\r\nTransfer-Encoding: chunked\r\n", CHUNK),
        (b"200 OK\r\n", PIECE),
        (b"503 Busy\r\nTransfer-Encoding: chunked\r\n", CHUNK),
        (b"401 Unauthorized\r\nTransfer-Encoding: chunked\r\n" + CHALLENGE, CHUNK),
    ],
    ids=["600 MB", "chunked without end", "until it closes", "busy", "challenge"],
)
def sender(request: pytest.FixtureRequest) -> Iterator[Sender]:
    head, piece = request.param
    running = Sender(b"HTTP/1.1 " + head + b"\r\n", piece)
    yield running
    running.close()


@pytest.mark.parametrize("digest", [True, False], ids=["1.0", "2.0"])
def test_an_answer_too_long_is_given_up(sender: Sender, digest: bool) -> None:
    session = RwsHttp(sender.url, Credentials("u", "p"), PATIENT, digest, {})
    with pytest.raises(ControllerReplyError, match=rf"more than the {LARGEST} bytes") as refused:
        session.request("GET", "/rw/panel/opmode")
    session.close()
    assert "GET /rw/panel/opmode" in str(refused.value)
    assert "\n" not in str(refused.value)
    assert sender.sent < LARGEST + BUFFERS


def test_a_packed_answer_is_not_unpacked() -> None:
    head = b"HTTP/1.1 200 OK\r\nContent-Encoding: deflate\r\nContent-Length: %d\r\n\r\n" % len(PACKED)
    running = Sender(head, PACKED)
    session = RwsHttp(running.url, Credentials("u", "p"), PATIENT, True, {})
    with pytest.raises(ControllerReplyError, match="packed"):
        session.request("GET", "/rw/panel/opmode")
    session.close()
    running.close()
