"""Messages as nobody means them, on every topic that a node listens to: an answer or a diagnostic, and it goes on."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rclpy.clock import ClockType
from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message

from doormill_ros.localization.errors import BadCameraInfo, BadDoorFace, BadPicture, StalePicture
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.model_monitor import ModelMonitor
from support.cell_processes import NODES, CellProcesses
from support.hostile.listeners import FEWER, RUNS, Listener, feed, good_message, listeners, taps_of
from support.hostile.messages import hostile
from support.localizer_node import Localizer

DOOR = "thesis_190_0deg"
LISTENERS = listeners()


@pytest.mark.parametrize("listener", LISTENERS, ids=lambda listener: listener.name)
def test_no_message_meets_a_node_unexpectedly(
    listener: Listener, recorded: dict[str, bytes], context: Context, tmp_path: Path
) -> None:
    node = listener.up(context, tmp_path)
    said: list[str] = []
    node.report = lambda level, message, **values: said.append(message)
    taps = taps_of(node)
    assert taps
    fed: set[str] = set()
    sensor = listener.arguments.get("sensor", "")
    for run in range(FEWER.get(listener.kind, RUNS)):
        draw = random.Random(run)
        for tap in taps:
            good = good_message(tap, recorded, run, sensor)
            for number, message in enumerate((good, hostile(good, draw))):
                feed(tap, message, 2 * run + number)
            fed.add(tap.topic_name)
    assert [message for message in said if "unexpected" in message] == []
    assert fed == {tap.topic_name for tap in node.subscriptions if "_alive/" not in tap.topic_name}
    node.close()
    node.destroy_node()


def test_what_a_node_does_not_expect_would_be_seen(
    recorded: dict[str, bytes], context: Context, tmp_path: Path
) -> None:
    """A callback that fails is among what the test above looks at."""
    node = Listener(ModelMonitor).up(context, tmp_path)
    said: list[str] = []
    node.report = lambda level, message, **values: said.append(message)
    node._watch.take = None  # type: ignore[method-assign]
    (tap,) = (tap for tap in taps_of(node) if tap.topic_name == f"/{topics.DOOR_INSPECTION.name}")
    feed(tap, good_message(tap, recorded, 0), 0)
    assert any("unexpected" in message for message in said), said
    node.close()
    node.destroy_node()


@pytest.fixture
def localizer(recorded: dict[str, bytes], context: Context) -> Iterator[Localizer]:
    localizer = Localizer(recorded, context)
    yield localizer
    localizer.node.close()
    localizer.node.destroy_node()


@pytest.mark.parametrize(
    "changes",
    [
        {"k": [0.0] * 9},
        {"k": [float("nan")] * 9},
        {"width": 0},
        {"width": 4_294_967_295, "height": 4_294_967_295},
        {"distortion_model": "equidistant"},
        {"distortion_model": "fisheye", "d": [0.0] * 4},
        {"d": [float("nan")] * 5},
        {"d": [0.0] * 5},
        {"k": [1695.13, 0.0, 946.41, 0.0, 1744.49, 510.71, 0.0, 0.0, 1.0]},
    ],
    ids=lambda changes: " ".join(changes),
)
def test_after_a_camera_info_of_no_use_the_one_before_does_not_go_on(
    localizer: Localizer, changes: dict[str, Any]
) -> None:
    localizer.send(topics.CAMERA_INFO)
    assert localizer.answer().accepted
    for _ in range(2):
        localizer.send(topics.CAMERA_INFO, **changes)
        refused = localizer.answer()
        assert (refused.accepted, refused.error_code) == (False, BadCameraInfo.code)
        assert refused.run_id
        assert "camera info" in localizer.node._health[1]
    localizer.send(topics.CAMERA_INFO)
    assert localizer.answer().accepted


def test_pictures_and_doors_of_no_use_are_answered_under_the_run(localizer: Localizer) -> None:
    localizer.send(topics.CAMERA_INFO)
    run_id = localizer.answer().run_id
    for changes in (
        {"encoding": "mono16"},
        {"encoding": "bayer_rggb12"},
        {"data": []},
        {"width": 0, "step": 0},
    ):
        localizer.send(topics.IMAGE, **changes)
        refused = localizer.answers[-1]
        assert (refused.run_id, refused.error_code) == (run_id, BadPicture.code), changes
    for width in (0.0, -1.0, float("nan"), float("inf"), 1e9):
        localizer.send(topics.DOOR_RECIPE, width=width)
        assert localizer.answer().error_code == BadDoorFace.code
    localizer.send(topics.DOOR_RECIPE)
    assert localizer.answer().accepted


@pytest.mark.parametrize(("sec", "says"), [(-5, "old"), (0, "old"), (2_147_483_647, "future")])
def test_stamps_of_another_age_are_answered(localizer: Localizer, sec: int, says: str) -> None:
    localizer.send(topics.CAMERA_INFO)
    localizer.node.set_parameters([Parameter("check_age", value=True)])
    localizer.good[topics.IMAGE.name].header.stamp.sec = sec
    refused = localizer.answer()
    assert refused.error_code == StalePicture.code
    assert says in refused.reason


def test_a_fault_that_nobody_thought_of_is_an_answer(
    localizer: Localizer, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError("by nothing")

    localizer.send(topics.CAMERA_INFO)
    monkeypatch.setattr("doormill_ros.nodes.door_localizer.look", fail)
    refused = localizer.answer()
    assert not refused.accepted
    assert refused.error_code > 0
    assert "ZeroDivisionError: by nothing" in refused.reason


@pytest.mark.parametrize("listener", LISTENERS, ids=lambda listener: listener.name)
def test_no_timer_stands_still_when_the_wall_clock_is_set_back(
    listener: Listener, context: Context, tmp_path: Path
) -> None:
    node = listener.up(context, tmp_path)
    node.later("something", lambda: None)
    kinds = {timer.clock.clock_type for timer in node.timers}
    assert kinds == {ClockType.STEADY_TIME}
    node.close()
    node.destroy_node()


def test_a_cell_mills_after_a_storm_of_messages(tmp_path: Path, recorded: dict[str, bytes]) -> None:
    draw = random.Random(19)
    listened = [topic for topic in topics.ALL if f"/{topic.name}" in recorded]
    with CellProcesses(tmp_path, nodes=NODES[1:]) as cell:
        assert cell.mill(DOOR)[0].success
        storm = [
            (topic, cell.node.create_publisher(topic.type, topic.name, topic.offered)) for topic in listened
        ]
        for _ in range(4):
            for topic, publisher in storm:
                good = deserialize_message(recorded[f"/{topic.name}"], topic.type)
                publisher.publish(hostile(good, draw))
        for _, publisher in storm:  # what they latched is gone with them
            cell.node.destroy_publisher(publisher)
        results = [cell.mill(door)[0] for door in (DOOR, "thesis_1350_0deg", DOOR)]
        assert results[-1].success, [result.message for result in results]
        assert all(result.success or (result.error_code and result.message) for result in results)
        assert {name: "Traceback" in cell.log(name) for name in cell.processes} == dict.fromkeys(
            cell.processes, False
        )
