"""Bags as `rosbags` reads them: the same messages in the same order, and one class for one type."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.rosbag2 import Reader

from doormill_ros.recording.bag_reader import read_bag, topics_of
from doormill_ros.recording.errors import UnreadableBagError
from doormill_ros.recording.mcap_scan import MAGIC
from support.source_tree import ROOT

BAGS = sorted(path.parent for path in (ROOT / "bags").glob("*/metadata.yaml"))


@pytest.mark.parametrize("bag", BAGS, ids=lambda bag: bag.name)
def test_another_reader_finds_the_same(bag: Path) -> None:
    with Reader(bag) as reader:
        expected = [(c.topic, stamp, bytes(data), c.msgtype) for c, stamp, data in reader.messages()]
        assert set(topics_of(bag)) == {connection.topic for connection in reader.connections}
    assert [(m.topic, m.stamp_ns, m.data, m.type_name) for m in read_bag(bag)] == expected
    for topic in sorted({topic for topic, *_ in expected})[:3]:
        found = [(m.topic, m.stamp_ns, m.data, m.type_name) for m in read_bag(bag, [topic])]
        assert found == [one for one in expected if one[0] == topic]


def test_what_messages_of_different_types_hold_can_be_compared() -> None:
    (bag,) = (bag for bag in BAGS if bag.name == "thesis_190_0deg")
    headers = [m.message.header for m in read_bag(bag) if hasattr(m.message, "header")]
    assert len(headers) > 3
    assert len({type(header) for header in headers}) == 1


@pytest.mark.parametrize(
    ("place", "why"),
    [
        ("empty", "it holds neither metadata.yaml nor a .mcap file"),
        ("file.txt", "it is neither a folder nor a .mcap file"),
        ("absent", "there is no such folder"),
    ],
)
def test_what_is_no_bag_is_told_with_what_it_lacks(tmp_path: Path, place: str, why: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "file.txt").touch()
    for read in (topics_of, lambda bag: list(read_bag(bag))):
        with pytest.raises(UnreadableBagError) as refused:
            read(tmp_path / place)
        assert refused.value.message == (
            f"bag {tmp_path / place} cannot be read: {why}; name a folder with metadata.yaml and .mcap files"
        )


def test_a_damaged_bag_is_to_be_copied_again(tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information: {}")
    (bag / "bag_0.mcap").write_bytes(MAGIC + b"no record at all" * 100 + MAGIC)
    with pytest.raises(UnreadableBagError, match=r"; take another copy of the bag$"):
        list(read_bag(bag))
