"""The layouts for Foxglove and RViz name topics that the cell has, in frames that the messages carry."""

from __future__ import annotations

import json
import re

import yaml

from doormill_ros.frames import BASE_FRAME
from doormill_ros.recording.bag_reader import read_bag, topics_of
from source_tree import ROOT

BAG = ROOT / "bags" / "thesis_190_0deg"
#: Excluded from the reference bags, and published by nobody but a robot_state_publisher.
ELSEWHERE = {"/door/overlay", "/robot_description"}


def test_foxglove_layout_shows_recorded_topics() -> None:
    layout = json.loads((ROOT / "config" / "foxglove-layout.json").read_text())
    panels = set(layout["configById"])
    assert set(re.findall(r'"((?:\w+)!\w+)"', json.dumps(layout["layout"]))) == panels
    named = set(re.findall(r'"(/[a-z]\w*/?\w*)', json.dumps(layout["configById"])))
    assert len(named) >= 10
    assert named - ELSEWHERE <= set(topics_of(BAG))


def test_rviz_shows_recorded_topics_with_the_durability_they_have() -> None:
    document = yaml.safe_load((ROOT / "config" / "cell.rviz").read_text())
    manager = document["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == BASE_FRAME
    named = {
        d["Topic"]["Value"]: d["Topic"]["Durability Policy"] for d in manager["Displays"] if "Topic" in d
    }
    assert len(named) == 5
    assert set(named) - ELSEWHERE <= set(topics_of(BAG))
    assert {t for t, durability in named.items() if durability == "Transient Local"} == {
        "/path/nominal", "/path/corrected", "/path/markers"
    }  # fmt: skip


def test_shown_messages_are_in_the_base_frame() -> None:
    frames = {}
    for item in read_bag(BAG, ["/path/nominal", "/path/corrected", "/door/pose", "/path/markers"]):
        header = item.message.markers[-1].header if item.topic == "/path/markers" else item.message.header
        frames[item.topic] = header.frame_id
    assert frames == dict.fromkeys(frames, BASE_FRAME)
    assert len(frames) == 4
