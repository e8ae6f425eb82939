"""Further files of a split bag begin with what is latched; read as a whole it gives each message once."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Channel
from rosbags.rosbag2 import Reader

from bags.repack import repack_bag
from doormill_ros.recording.bag_reader import bag_files, read_bag
from doormill_ros.recording.bag_writer import BagWriter
from support.bag_content import noise, offered, text

LATCHED, VOLATILE = offered(depth=1), offered("volatile", depth=10)
SPLIT = 20_000  # bytes
SENT = 90


def write(folder: Path, close: bool = True, split: int = SPLIT) -> BagWriter:
    """A state that changes every twentieth time, two static frames, and events that do not compress."""
    writer = BagWriter(folder, split, ros_distro="kilted", device="millpc/cell1")
    writer.add_topic("/state", "std_msgs/msg/String", LATCHED)
    writer.add_topic("/tf_static", "std_msgs/msg/String", LATCHED)
    writer.add_topic("/event", "std_msgs/msg/String", VOLATILE)
    writer.write("/tf_static", text("tool"), 10)
    writer.write("/tf_static", text("camera"), 11)
    for number in range(SENT):
        if number % 20 == 0:
            writer.write("/state", text(f"state {number}"), 1000 + 2 * number, 500 + number)
        writer.write("/event", text(f"{number} {noise(number)}"), 1001 + 2 * number)
        writer.flush(force=True)
    if close:
        writer.close()
    return writer


def latched_of(path: Path) -> list[str]:
    """What a viewer of one file finds of the latched topics before the first event, by another library."""
    found = []
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            if channel.topic == "/event":
                return found
            found.append(message.data[8:-1].decode())
    return found


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("split") / "bag"
    write(folder)
    return folder


def events(path: Path) -> list[int]:
    return [int(m.message.data.split()[0]) for m in read_bag(path, ["/event"])]


def test_each_file_begins_with_the_state_of_then(bag: Path) -> None:
    files = bag_files(bag)
    assert len(files) > 3
    for number in range(1, 4):
        first = events(files[number])[0]
        latest = 20 * ((first - 1) // 20)
        assert sorted(latched_of(files[number])[:3]) == sorted(["tool", "camera", f"state {latest}"])


def test_what_is_repeated_comes_after_the_file_before_and_was_sent_then(bag: Path) -> None:
    files = bag_files(bag)
    last = max(m.stamp_ns for m in read_bag(files[0]))
    state = list(read_bag(files[0], ["/state"]))[-1].message.data.split()[1]
    with files[1].open("rb") as stream:
        messages = [m for _, c, m in make_reader(stream).iter_messages() if c.topic == "/state"]
    assert messages[0].log_time == last + 1
    assert messages[0].publish_time == 500 + int(state)


@pytest.mark.parametrize("broken_off", [False, True])
def test_the_whole_gives_each_message_once(tmp_path: Path, broken_off: bool) -> None:
    write(tmp_path / "bag", close=not broken_off)
    counts = Counter(m.topic for m in read_bag(tmp_path / "bag"))
    assert counts == {"/event": SENT, "/state": 5, "/tf_static": 2}
    assert events(tmp_path / "bag") == list(range(SENT))
    repack_bag(tmp_path / "bag", tmp_path / "one")
    assert Counter(m.topic for m in read_bag(tmp_path / "one")) == counts


def test_the_metadata_counts_what_is_in_the_files(bag: Path) -> None:
    with Reader(bag) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())
        repeated = reader.topics["/state"].msgcount - 5
    assert repeated == len(bag_files(bag)) - 1


def test_states_that_would_fill_the_file_are_not_repeated(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag", SPLIT)
    writer.add_topic("/state", "std_msgs/msg/String", LATCHED)
    writer.add_topic("/small", "std_msgs/msg/String", LATCHED)
    writer.write("/small", text("small"), 1)
    for number in range(8):
        writer.write("/state", text("".join(noise(10 * number + k) for k in range(9))), 10 + number)
        writer.flush(force=True)
    writer.close()
    files = bag_files(tmp_path / "bag")
    assert len(files) > 2
    assert [channels_of(path)[0].topic for path in files[1:]] == ["/small"] * (len(files) - 1)
    # Of the state each is there once, in one file or the other.
    assert sum(1 for path in files for _ in read_bag(path, ["/state"])) == 8


def channels_of(path: Path) -> list[Channel]:
    """Of the messages of a file in turn."""
    with path.open("rb") as stream:
        return [channel for _, channel, _ in make_reader(stream).iter_messages()]


def test_every_file_has_foxglove_s_record_with_a_key_of_its_own(bag: Path) -> None:
    keys = set()
    for path in bag_files(bag):
        with path.open("rb") as stream:
            (record,) = [r for r in make_reader(stream).iter_metadata() if r.name == "foxglove"]
        assert record.metadata["deviceName"] == "millpc/cell1"
        keys.add(record.metadata["key"])
    assert len(keys) == len(bag_files(bag)) > 1
