"""metadata.yaml of a rosbag2 folder, version 9."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from doormill_ros.files import write_atomically
from doormill_ros.yaml_text import text_of

VERSION = 9
METADATA = "metadata.yaml"  #: name of the file in a bag's folder
INFORMATION = "rosbag2_bagfile_information"  #: the one key of the document


@dataclass
class TopicRecord:
    """A recorded topic and how many messages it has so far."""

    name: str
    type: str
    type_hash: str
    qos_profiles: list[dict[str, Any]]
    message_count: int = 0


@dataclass
class FileRecord:
    """One MCAP file of the bag; times in nanoseconds since the epoch."""

    name: str
    start_ns: int | None = None
    end_ns: int | None = None
    message_count: int = 0

    def count(self, stamp_ns: int) -> None:
        """Take a message into account."""
        self.message_count += 1
        self.start_ns = stamp_ns if self.start_ns is None else min(self.start_ns, stamp_ns)
        self.end_ns = stamp_ns if self.end_ns is None else max(self.end_ns, stamp_ns)


@dataclass
class BagRecord:
    """What metadata.yaml says of the bag."""

    ros_distro: str
    topics: dict[str, TopicRecord] = field(default_factory=dict)
    files: list[FileRecord] = field(default_factory=list)
    custom: dict[str, str] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """The content of metadata.yaml."""
        starts = [f.start_ns for f in self.files if f.start_ns is not None]
        ends = [f.end_ns for f in self.files if f.end_ns is not None]
        start = min(starts, default=0)
        return {
            INFORMATION: {
                "version": VERSION,
                "storage_identifier": "mcap",
                "duration": {"nanoseconds": max(ends, default=0) - start},
                "starting_time": {"nanoseconds_since_epoch": start},
                "message_count": sum(f.message_count for f in self.files),
                "topics_with_message_count": [
                    {
                        "topic_metadata": {
                            "name": t.name,
                            "type": t.type,
                            "serialization_format": "cdr",
                            "offered_qos_profiles": t.qos_profiles,
                            "type_description_hash": t.type_hash,
                        },
                        "message_count": t.message_count,
                    }
                    for t in self.topics.values()
                ],
                "compression_format": "",
                "compression_mode": "",
                "relative_file_paths": [f.name for f in self.files],
                "files": [
                    {
                        "path": f.name,
                        "starting_time": {"nanoseconds_since_epoch": f.start_ns or 0},
                        "duration": {"nanoseconds": (f.end_ns or 0) - (f.start_ns or 0)},
                        "message_count": f.message_count,
                    }
                    for f in self.files
                ],
                "custom_data": self.custom or None,
                "ros_distro": self.ros_distro,
            }
        }

    def write(self, folder: Path) -> None:
        """Replace metadata.yaml at once, so that a reader never sees half of it."""
        write_atomically(folder / METADATA, text_of(self.document()))
