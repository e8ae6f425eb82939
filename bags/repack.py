"""Write a bag anew: one that was broken off gets its end, its index and its counts; any gets smaller."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import mcap.writer
import yaml
import zstandard

from doormill_ros.recording.bag_reader import bag_files
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.errors import UnreadableBagError
from doormill_ros.recording.mcap_scan import scan
from doormill_ros.recording.schema import Schema


def repack_bag(source: Path, target: Path, without: Collection[str] = (), level: int = 3) -> None:
    """Copy every message that can be read into a new bag; schemas, hashes and QoS travel along.

    Args:
        source: Bag folder, finished or broken off.
        target: Made; must not exist or be empty.
        without: Topics to leave out.
        level: Of compression, 1..22.

    Raises:
        UnreadableBagError: The folder holds no MCAP file.
        BagExistsError: The target holds files.
    """
    files = bag_files(source)
    if not files:
        raise UnreadableBagError(
            f"bag {source} holds no .mcap file; name a bag folder of this project", folder=str(source)
        )
    with _compression(level):
        writer = BagWriter(target, ros_distro=_distro(source))
        for path in files:
            for item in scan(path):
                channel = item.channel
                if channel.topic in without:
                    continue
                schema = Schema(
                    item.schema.name,
                    item.schema.data.decode("utf-8"),
                    channel.metadata.get("topic_type_hash", ""),
                )
                qos = yaml.safe_load(channel.metadata.get("offered_qos_profiles", "")) or []
                writer.add_topic(channel.topic, schema.name, qos, schema)
                message = item.message
                writer.write(channel.topic, message.data, message.log_time, message.publish_time)
        writer.close()


def _distro(source: Path) -> str:
    path = source / "metadata.yaml"
    document = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return document.get("rosbag2_bagfile_information", {}).get("ros_distro", "") or ""


@contextmanager
def _compression(level: int) -> Iterator[None]:
    """The writer of the mcap library compresses at level 3 and offers no other."""
    usual = mcap.writer.zstandard
    better = type(
        "zstandard", (), {"compress": staticmethod(functools.partial(zstandard.compress, level=level))}
    )
    mcap.writer.zstandard = better
    try:
        yield
    finally:
        mcap.writer.zstandard = usual
