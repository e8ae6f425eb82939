"""A run whose pictures came compressed is replayed like any other."""

from __future__ import annotations

import array
import io
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import CompressedImage, Image

from doormill_ros.nodes.replay.live_replay import LiveOptions, replay_live
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.recording.replay.replay import replay_bag
from doormill_ros.recording.replay.run_reader import read_runs
from support.source_tree import ROOT

RAW = "/camera/image_raw"
COMPRESSED = f"{RAW}/compressed"
SOURCE = ROOT / "bags" / "thesis_190_0deg"


def compressed(data: bytes) -> bytes:
    """A serialized picture as PNG, which loses nothing."""
    picture = deserialize_message(data, Image)
    out = io.BytesIO()
    grey = np.frombuffer(picture.data, np.uint8).reshape(picture.height, picture.width)
    Pillow.fromarray(grey).save(out, "PNG", compress_level=1)
    packed = array.array("B", out.getvalue())
    return serialize_message(CompressedImage(header=picture.header, format="mono8; png", data=packed))


def recorded(folder: Path, both: bool) -> Path:
    """The bag with its pictures compressed, or as a driver sends them: both."""
    writer = BagWriter(folder)
    for item in read_bag(SOURCE):
        if both or item.topic != RAW:
            writer.add_topic(item.topic, item.type_name)
            writer.write(item.topic, item.data, item.stamp_ns)
        if item.topic == RAW:
            writer.add_topic(COMPRESSED, "sensor_msgs/msg/CompressedImage")
            writer.write(COMPRESSED, compressed(item.data), item.stamp_ns)
    writer.close()
    return folder


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded(tmp_path_factory.mktemp("compressed") / "bag", both=False)


def run_of(bag: Path) -> RecordedRun:
    (run,) = read_runs(bag)
    return run


def test_it_is_replayed_without_a_difference(bag: Path) -> None:
    assert run_of(bag).image_transport == "compressed"
    outcome = replay_bag(bag)
    assert outcome.found == []
    assert outcome.counts["/door/localization"] == replay_bag(SOURCE).counts["/door/localization"]


def test_the_nodes_answer_as_recorded(bag: Path) -> None:
    answers = replay_live(run_of(bag), LiveOptions(rate=math.inf))
    accepted = {answer.topic: answer.accepted for answer in answers}
    assert accepted["/door/localization"]
    assert accepted["/path/targets"]


def test_the_picture_itself_counts_where_it_was_recorded_too(tmp_path: Path) -> None:
    run = run_of(recorded(tmp_path / "bag", both=True))
    assert run.image_transport == "raw"
    assert {hasattr(picture, "encoding") for picture in run.pictures.values()} == {True}
