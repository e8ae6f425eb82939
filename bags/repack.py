"""Write a bag anew: one that was broken off gets its end, its index and its counts; any gets smaller.

`. ./activate; python bags/repack.py BAG NEW [--without TOPIC ...] [--level 1..22]`
"""

from __future__ import annotations

import argparse
import functools
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import mcap.writer
import yaml
import zstandard

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from doormill_ros.errors import DoormillError
from doormill_ros.recording.bag_reader import bag_files, scan_further
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
            for item in scan(path) if path == files[0] else scan_further(path):
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


def main(arguments: list[str] | None = None) -> int:
    """Repack as the command line says; 2 when that cannot be done."""
    parser = argparse.ArgumentParser(
        prog="repack", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("bag", type=Path, help="bag folder, finished or broken off")
    parser.add_argument("new", type=Path, help="bag folder to write; must not exist or be empty")
    parser.add_argument("--without", metavar="TOPIC", action="append", default=[], help="leave a topic out")
    parser.add_argument("--level", type=int, choices=range(1, 23), default=3, help="of compression")
    options = parser.parse_args(arguments)
    try:
        repack_bag(options.bag, options.new, options.without, options.level)
    except DoormillError as error:
        print(f"repack: {error.message}", file=sys.stderr)
        return 2
    print(options.new)
    return 0


if __name__ == "__main__":
    sys.exit(main())
