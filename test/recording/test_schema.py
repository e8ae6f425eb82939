"""Definitions and hashes that travel in a bag, held to another implementation's."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from doormill_ros.recording.errors import UnknownTypeError
from doormill_ros.recording.schema import load_schema
from source_tree import ROOT

OWN = [f"doormill_interfaces/msg/{p.stem}" for p in sorted((ROOT / "doormill_interfaces/msg").glob("*.msg"))]
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


@pytest.mark.parametrize("name", OWN + FOREIGN)
def test_hash_is_what_rosbags_computes_from_the_text(name: str) -> None:
    """Text and hash come from different files of the install tree; rosbags derives one from the other."""
    schema = load_schema(name)
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(schema.text, name))
    assert store.hash_rihs01(name) == schema.type_hash


@pytest.mark.parametrize("name", FOREIGN)
def test_text_says_the_same_as_the_one_rosbags_writes(name: str) -> None:
    theirs = get_typestore(Stores.ROS2_JAZZY).generate_msgdef(name, ros_version=2)[0]
    ours = get_types_from_msg(load_schema(name).text, name)
    assert ours[name] == get_types_from_msg(theirs, name)[name]
    assert ours.keys() == get_types_from_msg(theirs, name).keys()


def test_a_type_that_is_not_installed_is_refused() -> None:
    with pytest.raises(UnknownTypeError, match="nowhere_msgs/msg/Nothing"):
        load_schema("nowhere_msgs/msg/Nothing")


def test_types_are_looked_for_in_every_prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{os.environ['AMENT_PREFIX_PATH']}")
    load_schema.cache_clear()
    assert load_schema("std_msgs/msg/Bool").text.strip().endswith("bool data")
