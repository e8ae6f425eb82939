"""Whether the chunks of an MCAP file hold what was recorded, by the checksums that stand in it."""

from __future__ import annotations

from pathlib import Path

from mcap.records import Chunk
from mcap.stream_reader import StreamReader, get_chunk_data_stream

from doormill_ros.recording.errors import UnreadableBagError
from doormill_ros.recording.mcap_scan import LARGEST_RECORD


def check_sums(path: Path) -> None:
    """Refuse a closed file with a chunk that is damaged, whatever it holds.

    Raises:
        UnreadableBagError: There is one.
        OSError: The file cannot be read.
    """
    number = 0
    with path.open("rb") as stream:
        try:
            for record in StreamReader(stream, emit_chunks=True, record_size_limit=LARGEST_RECORD).records:
                if isinstance(record, Chunk):
                    number += 1
                    get_chunk_data_stream(record, validate_crc=True)
        except OSError:
            raise
        except Exception as error:  # the library and what unpacks raise many kinds
            raise UnreadableBagError(
                f"bag file {path} is damaged in or behind its chunk {number}: {error}; take another copy of the bag",
                bag=str(path),
                chunk=number,
            ) from error
