"""A bag of a few kilobytes may not ask for all memory."""

from __future__ import annotations

import struct
from pathlib import Path

import lz4.frame
import pytest
import zstandard

from doormill_ros.recording.errors import UnreadableBagError
from doormill_ros.recording.mcap_chunks import LARGEST_CHUNK, check_chunks
from support.source_tree import ROOT

MAGIC = b"\x89MCAP0\r\n"
BOMB = LARGEST_CHUNK + 1


def chunk(compression: str, packed: bytes, stated: int) -> bytes:
    name = compression.encode()
    content = (
        struct.pack("<QQQII", 0, 1, stated, 0, len(name)) + name + struct.pack("<Q", len(packed)) + packed
    )
    return struct.pack("<BQ", 6, len(content)) + content


def zeros(compression: str, size: int, known: bool) -> bytes:
    """Zeros, packed, with or without their number in the frame's head."""
    block = bytes(1 << 20)
    parts = [block] * (size >> 20) + [bytes(size & 0xFFFFF)]
    if compression == "zstd":
        packer = zstandard.ZstdCompressor().compressobj(size=size if known else -1)
        return b"".join(packer.compress(part) for part in parts) + packer.flush()
    frame = lz4.frame.LZ4FrameCompressor()
    begin = frame.begin(size if known else 0)
    return begin + b"".join(frame.compress(part) for part in parts) + frame.flush()


def write(path: Path, *records: bytes) -> Path:
    path.write_bytes(MAGIC + b"".join(records) + MAGIC)
    return path


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
@pytest.mark.parametrize("known", [True, False])
def test_a_chunk_that_unpacks_to_too_much_is_refused(tmp_path: Path, compression: str, known: bool) -> None:
    bomb = zeros(compression, BOMB, known)
    assert len(bomb) < LARGEST_CHUNK / 100
    # What the chunk states is a lie.
    path = write(tmp_path / "a.mcap", chunk("", b"x", 1), chunk(compression, bomb, 1000))
    with pytest.raises(UnreadableBagError, match="chunk 2 of"):
        check_chunks(path)


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
@pytest.mark.parametrize("known", [True, False])
def test_a_chunk_of_the_largest_size_passes(tmp_path: Path, compression: str, known: bool) -> None:
    packed = zeros(compression, LARGEST_CHUNK, known)
    check_chunks(write(tmp_path / "a.mcap", chunk(compression, packed, LARGEST_CHUNK)))
    with pytest.raises(UnreadableBagError):
        check_chunks(write(tmp_path / "b.mcap", chunk(compression, packed, LARGEST_CHUNK + 1)))


def test_recorded_bags_and_damaged_ones_pass(tmp_path: Path) -> None:
    recorded = sorted((ROOT / "bags").glob("*/*.mcap"))
    assert recorded
    for path in recorded:
        check_chunks(path)
    data = recorded[0].read_bytes()
    for cut in (0, 5, 8, 20, 100, len(data) // 2):
        (tmp_path / "cut.mcap").write_bytes(data[:cut])
        check_chunks(tmp_path / "cut.mcap")
    check_chunks(write(tmp_path / "a.mcap", struct.pack("<BQ", 6, 1 << 60)))
