"""Definitions and hashes that travel in a bag, held to another implementation's."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.serialization import serialize_message
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import TFMessage
from doormill_ros.recording.errors import UnknownTypeError
from doormill_ros.recording.schema import load_schema
from support.source_tree import ROOT
from support.waiting import LIMIT

FEEDBACK = "doormill_interfaces/action/MillDoor_FeedbackMessage"
OWN = [f"doormill_interfaces/msg/{p.stem}" for p in sorted((ROOT / "doormill_interfaces/msg").glob("*.msg"))]
FRAMES, TF2_FRAMES = "doormill_interfaces/msg/TFMessage", "tf2_msgs/msg/TFMessage"
FOREIGN = [
    "builtin_interfaces/msg/Time",
    "diagnostic_msgs/msg/DiagnosticArray",
    "geometry_msgs/msg/PoseStamped",
    "lifecycle_msgs/msg/TransitionEvent",
    "nav_msgs/msg/Path",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/Image",
    "std_msgs/msg/Bool",
    "std_msgs/msg/String",
    "visualization_msgs/msg/MarkerArray",
]


def test_there_are_types_to_check() -> None:
    assert len(OWN) >= 12


@pytest.mark.parametrize(
    "name", sorted({*OWN, *FOREIGN, FEEDBACK, "action_msgs/msg/GoalStatusArray"} - {FRAMES})
)
def test_hash_is_what_rosbags_computes_from_the_text(name: str) -> None:
    """Text and hash come from different files of the install tree; rosbags derives one from the other."""
    schema = load_schema(name)
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(schema.text, name))
    assert store.hash_rihs01(name) == schema.type_hash


def test_our_message_of_frames_travels_as_the_one_of_tf2() -> None:
    """Held to the definition and hash of tf2_msgs that rosbags brings along."""
    schema, theirs = load_schema(FRAMES), get_typestore(Stores.ROS2_JAZZY)
    assert (schema.name, schema.type_hash) == (TF2_FRAMES, theirs.hash_rihs01(TF2_FRAMES))
    asked = load_schema(TF2_FRAMES)  # as who copies a bag asks
    assert (asked.name, asked.type_hash) == (schema.name, schema.type_hash)
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(schema.text, TF2_FRAMES))
    stamped = TransformStamped(child_frame_id="door")
    stamped.transform.translation.y = 0.5
    data = serialize_message(TFMessage(transforms=[stamped]))
    for reader in (store, theirs):
        (read,) = reader.deserialize_cdr(data, TF2_FRAMES).transforms
        assert (read.child_frame_id, read.transform.translation.y) == ("door", 0.5)


@pytest.mark.parametrize("name", FOREIGN)
def test_text_says_the_same_as_the_one_rosbags_writes(name: str) -> None:
    theirs = get_typestore(Stores.ROS2_JAZZY).generate_msgdef(name, ros_version=2)[0]
    ours = get_types_from_msg(load_schema(name).text, name)
    assert ours[name] == get_types_from_msg(theirs, name)[name]
    assert ours.keys() == get_types_from_msg(theirs, name).keys()


def test_the_feedback_of_an_action_can_be_read_by_who_has_no_package() -> None:
    schema = load_schema(FEEDBACK)
    message = MillDoor.Impl.FeedbackMessage(feedback=MillDoor.Feedback(stage="pose", progress=0.5))
    message.goal_id.uuid[:] = np.arange(16)
    data = serialize_message(message)
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(schema.text, FEEDBACK))
    read = store.deserialize_cdr(data, FEEDBACK)
    assert list(read.goal_id.uuid) == list(range(16))
    assert (read.feedback.stage, read.feedback.progress) == ("pose", 0.5)


def test_the_feedback_of_an_action_has_the_hash_that_ros_gives_its_topic() -> None:
    rclpy.init()
    try:
        node = rclpy.create_node("beside")
        publisher = node.create_publisher(MillDoor.Impl.FeedbackMessage, "feedback", 1)
        found: list[TopicEndpointInfo] = []
        deadline = time.monotonic() + LIMIT
        while not found and time.monotonic() < deadline:
            found = node.get_publishers_info_by_topic(publisher.topic_name)
            time.sleep(0.02)
        assert str(found[0].topic_type_hash) == load_schema(FEEDBACK).type_hash
        assert found[0].topic_type == FEEDBACK
    finally:
        rclpy.shutdown()


def test_an_action_that_is_not_installed_is_refused() -> None:
    with pytest.raises(UnknownTypeError, match="nowhere_msgs/action/Nothing"):
        load_schema("nowhere_msgs/action/Nothing_FeedbackMessage")


def test_a_type_that_is_not_installed_is_refused() -> None:
    with pytest.raises(UnknownTypeError, match="nowhere_msgs/msg/Nothing"):
        load_schema("nowhere_msgs/msg/Nothing")


def test_types_are_looked_for_in_every_prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{os.environ['AMENT_PREFIX_PATH']}")
    load_schema.cache_clear()
    assert load_schema("std_msgs/msg/Bool").text.strip().endswith("bool data")
