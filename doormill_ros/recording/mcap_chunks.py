"""How much the chunks of an MCAP file unpack to, before anything unpacks them.

A few kilobytes can hold many gigabytes, and the libraries that read bags unpack whatever a chunk holds. The size that
the chunk states is not to be trusted: what counts is what comes out of its frame.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import lz4.frame
import zstandard

from doormill_ros.recording.errors import UnreadableBagError

LARGEST_CHUNK = 1 << 28  #: more than the recorder ever puts into one [bytes]
_MAGIC = 8  # bytes
_CHUNK = 0x06
_RECORD = struct.Struct("<BQ")  # opcode and length of the content
_HEAD = struct.Struct(
    "<QQQII"
)  # first and last time, unpacked size, checksum, length of the compression's name
_LENGTH = struct.Struct("<Q")


def check_chunks(path: Path) -> None:
    """Refuse a file with a chunk that unpacks to more than `LARGEST_CHUNK`.

    What is damaged is left to whoever reads the file.

    Raises:
        UnreadableBagError: There is one.
        OSError: The file cannot be read.
    """
    with path.open("rb") as stream:
        for number, (compression, stated, packed) in enumerate(_chunks(stream), start=1):
            if stated > LARGEST_CHUNK or _unpacks_to_more(compression, packed):
                raise UnreadableBagError(
                    f"bag file {path}: chunk {number} of {len(packed)} bytes unpacks to more than {LARGEST_CHUNK} "
                    "bytes, no recorder writes such a one; take another copy of the bag",
                    bag=str(path),
                    chunk=number,
                    allowed=LARGEST_CHUNK,
                )


def _chunks(stream: BinaryIO) -> Iterator[tuple[str, int, bytes]]:
    """Compression, stated size and packed content of each chunk, up to where the file makes no sense."""
    size = stream.seek(0, 2)
    stream.seek(_MAGIC)
    while len(record := stream.read(_RECORD.size)) == _RECORD.size:
        opcode, length = _RECORD.unpack(record)
        end = stream.tell() + length
        if end > size:
            return
        if opcode == _CHUNK and length >= _HEAD.size:
            *_, stated, _, name = _HEAD.unpack(stream.read(_HEAD.size))
            if name <= length - _HEAD.size - _LENGTH.size:
                compression = stream.read(name).decode("latin-1")
                stream.seek(_LENGTH.size, 1)
                yield compression, stated, stream.read(end - stream.tell())
        stream.seek(end)


def _unpacks_to_more(compression: str, packed: bytes) -> bool:
    try:
        if compression == "zstd":
            known = int(zstandard.frame_content_size(packed))
            if known >= 0:
                return known > LARGEST_CHUNK
            left = LARGEST_CHUNK
            for part in zstandard.ZstdDecompressor().read_to_iter(packed):
                left -= len(part)
                if left < 0:
                    return True
        elif compression == "lz4":
            known = int(lz4.frame.get_frame_info(packed)["content_size"])
            if known:
                return known > LARGEST_CHUNK
            unpacker, left = lz4.frame.LZ4FrameDecompressor(), LARGEST_CHUNK
            part = unpacker.decompress(packed, max_length=1 << 20)
            while part:
                left -= len(part)
                if left < 0:
                    return True
                part = b"" if unpacker.eof else unpacker.decompress(b"", max_length=1 << 20)
    except (zstandard.ZstdError, RuntimeError, EOFError, ValueError):
        return False
    return False
