"""Bags that the recorder writes, read by two other libraries."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from bags.repack import repack_bag
from doormill_ros.recording.bag_reader import bag_files, is_broken_off, read_bag, topics_of
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.errors import BagExistsError, UnreadableBagError
from support.bag_content import SIZE, noise, offered, text
from support.source_tree import ROOT
from support.waiting import LIMIT

QOS = offered()
LARGE = 10_000  # bytes


def write(folder: Path, count: int, split_size: int = 0, close: bool = True) -> BagWriter:
    """Texts that do not compress, and a flag now and then."""
    writer = BagWriter(folder, split_size, ros_distro="kilted")
    writer.add_topic("/text", "std_msgs/msg/String", QOS)
    writer.add_topic("/flag", "std_msgs/msg/Bool", QOS)
    for number in range(count):
        content = noise(number)
        writer.write("/text", text(f"{number} {content}"), 1000 + 2 * number)
        writer.write("/flag", b"\0\x01\0\0" + bytes([number % 2]), 1001 + 2 * number)
        writer.flush(force=not close)
    if close:
        writer.close({"/text": 3})
    return writer


def test_a_quarter_of_a_second_later_the_file_has_the_row(tmp_path: Path) -> None:
    now = 100.0
    writer = BagWriter(tmp_path / "bag", clock=lambda: now)
    writer.add_topic("/text", "std_msgs/msg/String", QOS)
    writer.flush(force=True)
    writer.write("/text", text("0"), 1000)
    now += 0.25
    writer.flush()
    assert numbers(tmp_path / "bag") == [0]
    writer.close()


def numbers(folder: Path) -> list[int]:
    return [int(m.message.data.split()[0]) for m in read_bag(folder, ["/text"])]


def test_both_libraries_read_what_was_written(tmp_path: Path) -> None:
    write(tmp_path / "bag", 20)
    with Reader(tmp_path / "bag") as reader:
        assert reader.message_count == 40
        assert {t: i.msgcount for t, i in reader.topics.items()} == {"/text": 20, "/flag": 20}
        assert reader.connections[0].ext.offered_qos_profiles[0].depth == 7
        stamps = [stamp for _, stamp, _ in reader.messages()]
    assert stamps == list(range(1000, 1040))
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        found = [(c.topic, s.name, s.encoding) for s, c, _ in make_reader(stream).iter_messages()]
    assert found.count(("/text", "std_msgs/msg/String", "ros2msg")) == 20
    assert found.count(("/flag", "std_msgs/msg/Bool", "ros2msg")) == 20


def test_metadata_has_the_form_of_another_rosbag2_writer(tmp_path: Path) -> None:
    write(tmp_path / "ours", 3)
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(tmp_path / "theirs", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/flag", "std_msgs/msg/Bool", typestore=store)
        writer.write(connection, 1000, b"\0\x01\0\0\1")

    def load(name: str) -> dict:
        return yaml.safe_load((tmp_path / name / "metadata.yaml").read_text())["rosbag2_bagfile_information"]

    ours, theirs = load("ours"), load("theirs")
    assert ours.keys() == theirs.keys()
    flag = next(t for t in ours["topics_with_message_count"] if t["topic_metadata"]["name"] == "/flag")
    other = theirs["topics_with_message_count"][0]
    assert flag.keys() == other.keys()
    assert flag["topic_metadata"].keys() == other["topic_metadata"].keys()
    assert flag["topic_metadata"]["type_description_hash"] == other["topic_metadata"]["type_description_hash"]
    assert ours["files"][0].keys() == theirs["files"][0].keys()
    assert ours["files"][0]["message_count"] == 6
    assert ours["duration"] == {"nanoseconds": 5}


def test_what_was_dropped_is_in_the_metadata(tmp_path: Path) -> None:
    write(tmp_path / "bag", 1)
    document = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    custom = document["rosbag2_bagfile_information"]["custom_data"]
    assert custom == {"dropped": "3", "dropped /text": "3"}


def test_a_bag_splits_by_size_and_loses_nothing(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag", split_size=LARGE)
    writer.add_topic("/text", "std_msgs/msg/String", QOS)
    for number in range(60):
        writer.write("/text", text(f"{number} {noise(number)}"), number)
        writer.flush(force=True)
    writer.close()
    files = bag_files(tmp_path / "bag")
    assert len(files) > 2
    # One message and the chunk around it is what a file may be larger than the limit, and its index.
    assert max(path.stat().st_size for path in files) < LARGE + 20 * SIZE
    assert numbers(tmp_path / "bag") == list(range(60))
    with Reader(tmp_path / "bag") as reader:
        assert reader.message_count == 60
    document = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert document["relative_file_paths"] == [path.name for path in files]
    assert sum(f["message_count"] for f in document["files"]) == 60


def test_a_folder_with_something_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("data")
    with pytest.raises(BagExistsError, match="not empty"):
        BagWriter(tmp_path)


def test_a_bag_without_end_is_read_as_far_as_it_goes_and_repaired(tmp_path: Path) -> None:
    write(tmp_path / "bag", 10, close=False)
    assert is_broken_off(tmp_path / "bag")
    assert topics_of(tmp_path / "bag") == ["/text", "/flag"]
    assert numbers(tmp_path / "bag") == list(range(10))
    repack_bag(tmp_path / "bag", tmp_path / "repaired")
    with Reader(tmp_path / "repaired") as reader:
        assert reader.message_count == 20
        assert reader.connections[0].ext.offered_qos_profiles[0].depth == 7
    assert [m.data for m in read_bag(tmp_path / "repaired")] == [m.data for m in read_bag(tmp_path / "bag")]


def test_repacking_leaves_out_topics_and_gets_smaller(tmp_path: Path) -> None:
    write(tmp_path / "bag", 10)
    repack_bag(tmp_path / "bag", tmp_path / "small", without=["/text"], level=19)
    assert topics_of(tmp_path / "small") == ["/flag"]
    assert (tmp_path / "small" / "small_0.mcap").stat().st_size < (
        tmp_path / "bag" / "bag_0.mcap"
    ).stat().st_size
    with pytest.raises(UnreadableBagError, match="holds no"):
        repack_bag(tmp_path / "nowhere", tmp_path / "never")


def test_repacking_is_a_command(tmp_path: Path) -> None:
    """As docs/recording.md gives it."""
    write(tmp_path / "bag", 10, close=False)
    script = ROOT / "bags" / "repack.py"
    assert "`python bags/repack.py BAG NEW`" in " ".join((ROOT / "docs" / "recording.md").read_text().split())

    def repack(*arguments: object) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, script, *map(str, arguments)]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=LIMIT)

    done = repack("bag", "new", "--without", "/flag")
    assert (done.returncode, done.stdout) == (0, "new\n"), done.stderr
    assert not is_broken_off(tmp_path / "new")
    assert topics_of(tmp_path / "new") == ["/text"]
    assert numbers(tmp_path / "new") == list(range(10))
    refused = repack("bag", "new")
    assert refused.returncode == 2
    assert "not empty" in refused.stderr
    assert "Traceback" not in refused.stderr


class Finished:
    """A closed file, and how large it was once each message had been handed to the system."""

    def __init__(self, folder: Path) -> None:
        writer = BagWriter(folder / "bag")
        path = folder / "bag" / "bag_0.mcap"
        writer.add_topic("/text", "std_msgs/msg/String", QOS)
        self.sizes = []
        for number in range(12):
            writer.write("/text", text(f"{number} x"), number)
            writer.flush(force=True)
            self.sizes.append(path.stat().st_size)
        writer.close()
        self.content = path.read_bytes()


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Finished:
    return Finished(tmp_path_factory.mktemp("finished"))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0.0, 1.0))
def test_a_file_cut_anywhere_gives_the_first_messages(
    finished: Finished, tmp_path: Path, share: float
) -> None:
    size = int(share * len(finished.content))
    cut = tmp_path / "cut"
    cut.mkdir(exist_ok=True)
    (cut / "cut_0.mcap").write_bytes(finished.content[:size])
    found = numbers(cut)
    assert found == list(range(len(found)))
    # The index after a chunk may be missing while the chunk itself is whole.
    whole = sum(written <= size for written in finished.sizes)
    assert whole <= len(found) <= whole + 1


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damage_gives_messages_or_one_clear_error(
    finished: Finished, tmp_path: Path, data: st.DataObject
) -> None:
    damaged = bytearray(finished.content)
    for _ in range(data.draw(st.integers(1, 5))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "damaged.mcap"
    path.write_bytes(damaged)
    with contextlib.suppress(UnreadableBagError):  # any other error fails
        assert len(list(read_bag(path))) <= 12


@pytest.mark.parametrize("content", [None, "", "not: a bag", "rosbag2_bagfile_information: 3"])
def test_a_folder_that_is_no_bag_is_refused(tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "metadata.yaml").write_text(content)
    with pytest.raises(UnreadableBagError, match="name a folder with"):
        list(read_bag(tmp_path))
