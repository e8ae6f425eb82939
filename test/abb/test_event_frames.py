"""Frames that are none end the event stream with one warning, and the next stream is read as before."""

from __future__ import annotations

import logging
import random
import threading
import time
import tracemalloc

import httpx
import pytest

from doormill_ros.abb.transports.rws_dialect import RWS1
from doormill_ros.abb.transports.rws_events import RwsEvents
from support.hostile.frames import BINARY, CLOSE, PING, TEXT, FrameServer, frame
from support.hostile.wire import FRAME

EVENT = FRAME.encode()
EDGES = [True, False, True]
#: Levels of the stream that comes last, and its frame.
LAST = [True, True, False, False, True, True]
GOOD = frame(b"".join(EVENT.replace(b">1<", b">%d<" % level).split(b"</li>")[0] + b"</li>" for level in LAST))
LIMIT = 60.0  # s
MEMORY = 20_000_000  # bytes

HOSTILE = {
    "reserved bits": frame(EVENT, reserved=5),
    "an opcode that is none": frame(EVENT, opcode=0x5),
    "a control opcode that is none": frame(b"", opcode=0xF),
    "a length without end": frame(EVENT, length=(1 << 63) - 1),
    "a length beyond 63 bits": frame(EVENT, length=1 << 63),
    "a large length": frame(b"", length=1 << 32),
    "longer than any event": frame(b"<li>" * 20_000),
    "fragments without end": frame(EVENT, final=False) + frame(b"<li>" * 1000, opcode=0, final=False) * 30,
    "a fragment of nothing": frame(EVENT, opcode=0),
    "a second beginning": frame(EVENT, final=False) + frame(EVENT),
    "a fragmented ping": frame(b"x", opcode=PING, final=False),
    "a ping of 200 bytes": frame(b"x" * 200, opcode=PING),
    "text that is not UTF-8": frame(b"\xff\xfe" + EVENT),
    "half a character": frame("ø".encode()[:1]),
    "a close of one byte": frame(b"\x03", opcode=CLOSE),
    "a close with a code that is none": frame(b"\x00\x01", opcode=CLOSE),
    "a masked frame": bytes([0x80 | TEXT, 0x80 | 4]) + b"abcd" + b"wxyz",
    "the end in a frame": frame(EVENT)[: len(EVENT) // 2],
    "the end in a length": b"\x81\x7f\x00\x00",
    "the end": b"",
    "no frame": b"HTTP/1.1 200 OK\r\n\r\n",
}


class Session:
    """Stands for the session with a controller whose subscriptions lead to a server of frames."""

    def __init__(self, address: str) -> None:
        self.url, self.tls = f"http://{address}", None

    def cookie_header(self) -> str:
        return "a=b"

    def request(self, method: str, path: str, **_: object) -> httpx.Response:
        return httpx.Response(201, headers={"Location": f"ws://controller/poll/{path.strip('/')[:3]}1"})


def heard(streams: list[bytes], caplog: pytest.LogCaptureFixture) -> tuple[list[bool], list[str]]:
    """The edges until those of the last stream have come, without them, and what was warned of."""
    edges: list[bool] = []
    with caplog.at_level(logging.WARNING), FrameServer([*streams, GOOD]) as server:
        events = RwsEvents(Session(server.address), RWS1, "diRequest", threading.Event())  # type: ignore[arg-type]
        events.start()
        deadline = time.monotonic() + LIMIT
        while edges[-len(LAST) :] != LAST:
            assert events._thread.is_alive()
            assert time.monotonic() < deadline, (edges, caplog.messages)
            edge = events.next_edge()
            if edge is None:
                time.sleep(0.005)
            else:
                edges.append(edge)
        events.close()
        assert not events._thread.is_alive()
    return edges[: -len(LAST)], [
        record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING
    ]


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_frame_ends_the_stream_and_nothing_else(
    name: str, caplog: pytest.LogCaptureFixture
) -> None:
    tracemalloc.start()
    try:
        edges, warnings = heard([HOSTILE[name]], caplog)
        assert tracemalloc.get_traced_memory()[1] < MEMORY
    finally:
        tracemalloc.stop()
    assert edges in ([], EDGES)
    assert len(warnings) == 1, warnings
    assert "signals are polled meanwhile" in warnings[0]


@pytest.mark.parametrize("fragments", [1, 5000])
def test_what_goes_on_without_end_is_given_up_before_it_is_kept(
    fragments: int, caplog: pytest.LogCaptureFixture
) -> None:
    """More comes than may be kept, in one frame or in many of which none is the last."""
    payload = b"<li>" * (MEMORY // 2 // fragments)
    stream = frame(payload, final=fragments == 1) + frame(payload, opcode=0, final=False) * (fragments - 1)
    assert len(stream) > 2 * MEMORY - 1
    tracemalloc.start()
    try:
        edges, warnings = heard([stream], caplog)
        assert tracemalloc.get_traced_memory()[1] < MEMORY
    finally:
        tracemalloc.stop()
    assert edges == []
    assert len(warnings) == 1, warnings


def test_frames_of_all_kinds_are_read_for_what_they_are(caplog: pytest.LogCaptureFixture) -> None:
    middle = len(EVENT) // 2
    stream = (
        frame(EVENT, opcode=BINARY)
        + frame(EVENT[:middle], final=False)
        + frame(b"are you there", opcode=PING)
        + frame(EVENT[middle:], opcode=0)
        + frame("Tür auf".encode())
        + frame((1000).to_bytes(2, "big"), opcode=CLOSE)
    )
    edges, warnings = heard([stream], caplog)
    assert edges == EDGES * 2
    assert warnings == []


@pytest.mark.parametrize("seed", range(4))
def test_streams_with_flipped_bits_never_end_the_listening(
    seed: int, caplog: pytest.LogCaptureFixture
) -> None:
    rng = random.Random(seed)
    streams = []
    for _ in range(3):
        stream = bytearray(frame(EVENT) + frame(EVENT, final=False) + frame(EVENT, opcode=0))
        for _ in range(rng.randint(1, 8)):
            stream[rng.randrange(len(stream))] ^= 1 << rng.randrange(8)
        streams.append(bytes(stream[: rng.randint(1, len(stream))]))
    edges, warnings = heard(streams, caplog)
    assert len(edges) <= 3 * len(EDGES) * len(streams)
    assert len(warnings) <= len(streams)
