"""Frames that are none end the event stream with one warning, and the next stream is read as before."""

from __future__ import annotations

import random
import tracemalloc

import pytest

from support.hostile import frames
from support.hostile.frames import BINARY, CLOSE, PING, TEXT, frame, heard

EVENT = frames.EVENT.encode()
EDGES = [True, False, True]
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


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_frame_ends_the_stream_and_nothing_else(name: str) -> None:
    tracemalloc.start()
    try:
        edges, warnings = heard([HOSTILE[name]])
        assert tracemalloc.get_traced_memory()[1] < MEMORY
    finally:
        tracemalloc.stop()
    assert edges in ([], EDGES)
    assert len(warnings) == 1, warnings
    assert "signals are polled meanwhile" in warnings[0]


@pytest.mark.parametrize("fragments", [1, 5000])
def test_what_goes_on_without_end_is_given_up_before_it_is_kept(fragments: int) -> None:
    """More comes than may be kept, in one frame or in many of which none is the last."""
    payload = b"<li>" * (MEMORY // 2 // fragments)
    stream = frame(payload, final=fragments == 1) + frame(payload, opcode=0, final=False) * (fragments - 1)
    assert len(stream) > 2 * MEMORY - 1
    tracemalloc.start()
    try:
        edges, warnings = heard([stream])
        assert tracemalloc.get_traced_memory()[1] < MEMORY
    finally:
        tracemalloc.stop()
    assert edges == []
    assert len(warnings) == 1, warnings


def test_frames_of_all_kinds_are_read_for_what_they_are() -> None:
    middle = len(EVENT) // 2
    stream = (
        frame(EVENT, opcode=BINARY)
        + frame(EVENT[:middle], final=False)
        + frame(b"are you there", opcode=PING)
        + frame(EVENT[middle:], opcode=0)
        + frame("Tür auf".encode())
        + frame((1000).to_bytes(2, "big"), opcode=CLOSE)
    )
    edges, warnings = heard([stream])
    assert edges == EDGES * 2
    assert warnings == []


@pytest.mark.parametrize("seed", range(4))
def test_streams_with_flipped_bits_never_end_the_listening(seed: int) -> None:
    rng = random.Random(seed)
    streams = []
    for _ in range(3):
        stream = bytearray(frame(EVENT) + frame(EVENT, final=False) + frame(EVENT, opcode=0))
        for _ in range(rng.randint(1, 8)):
            stream[rng.randrange(len(stream))] ^= 1 << rng.randrange(8)
        streams.append(bytes(stream[: rng.randint(1, len(stream))]))
    edges, warnings = heard(streams)
    assert len(edges) <= 3 * len(EDGES) * len(streams)
    assert len(warnings) <= len(streams)
