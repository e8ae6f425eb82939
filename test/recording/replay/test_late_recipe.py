"""A recorder that fell behind wrote pictures ahead of the recipe of their run."""

from __future__ import annotations

from pathlib import Path

from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import CameraInfo, Image

from doormill_interfaces.msg import DoorLocalization
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.recording.bag_reader import BagMessage, read_bag
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.replay.replay import replay_bag
from doormill_ros.recording.replay.run_reader import read_runs
from support.source_tree import ROOT

PICTURE, INFO, LOCALIZATION, RECIPE = (
    "/camera/image_raw",
    "/camera/camera_info",
    "/door/localization",
    "/door/recipe",
)
KINDS = {PICTURE: Image, INFO: CameraInfo, LOCALIZATION: DoorLocalization}
SOURCE = ROOT / "bags" / "thesis_190_0deg"


def again(item: BagMessage) -> bytes:
    """The message once more, of a picture taken a nanosecond later."""
    message = deserialize_message(item.data, KINDS[item.topic])
    message.header.stamp.nanosec += 1
    return serialize_message(message)


def late(writer: BagWriter, source: Path, at_ns: int) -> int:
    """Add a run whose recipe was recorded after two pictures and the first answer; give its last time [ns]."""
    items = list(read_bag(source))
    recipe_at = next(index for index, item in enumerate(items) if item.topic == RECIPE)
    recipe = items.pop(recipe_at)
    pictured = [item for item in items if item.topic in KINDS]
    rest = [item for item in items if item.topic not in KINDS]
    first = [(item.topic, item.type_name, item.data) for item in pictured]
    second = [(item.topic, item.type_name, again(item)) for item in pictured]
    ahead = [row for row in (*first, *second) if row[0] != LOCALIZATION]
    answered = [row for row in (*first, *second) if row[0] == LOCALIZATION]
    behind = [(recipe.topic, recipe.type_name, recipe.data), *answered[1:]]
    others = [(item.topic, item.type_name, item.data) for item in rest]
    for topic, type_name, data in (*ahead, answered[0], *behind, *others):
        at_ns += 1
        writer.add_topic(topic, type_name)
        writer.write(topic, data, at_ns)
    return at_ns


def test_every_picture_of_a_run_is_found_that_was_recorded_ahead_of_its_recipe(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag")
    late(writer, SOURCE, 1_000_000_000)
    writer.close()
    (run,) = read_runs(tmp_path / "bag")
    localized = {nanoseconds_of(message.header.stamp) for _, message in run.localizations}
    assert len(localized) == 2
    assert set(run.pictures) == set(run.camera_infos) == localized
    for stamp, info in run.camera_infos.items():
        assert nanoseconds_of(info.header.stamp) == stamp
    assert replay_bag(tmp_path / "bag").found == []


def test_a_picture_recorded_while_another_run_was_in_hand_is_its_own_runs(tmp_path: Path) -> None:
    doors = ("thesis_190_0deg", "thesis_1350_0deg")
    sources = sorted((ROOT / "bags" / door for door in doors), key=lambda bag: read_runs(bag)[0].begun_ns)
    writer = BagWriter(tmp_path / "bag")
    at_ns = 1_000_000_000
    for source in sources:
        at_ns = late(writer, source, at_ns)
    writer.close()
    runs = read_runs(tmp_path / "bag")
    assert [len(run.pictures) for run in runs] == [2, 2]
    for run in runs:
        assert set(run.pictures) == {nanoseconds_of(message.header.stamp) for _, message in run.localizations}
    assert replay_bag(tmp_path / "bag").found == []
