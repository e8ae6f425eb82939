"""A camera for which its library waits longer than the bridge does: the door is refused in time, with the reason."""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from std_msgs.msg import Bool

from doormill_interfaces.msg import DoorLocalization, DoorRecipe, RunResult
from doormill_ros.localization.gige.errors import NoPictureInTime
from doormill_ros.localization.gige.library import Aravis
from doormill_ros.localization.gige.waiting import SILENT
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.gige_camera import GigeCamera
from doormill_ros.nodes.replay.live_replay import LiveOptions, repeats_the_end, replay_live
from doormill_ros.recording.replay.answer import LOCALIZATION_STAGE, RECIPE_STAGE, RESULT_STAGE
from doormill_ros.recording.replay.offline import replay_offline
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.recording.replay.run_reader import read_runs
from support.source_tree import ROOT

NEVER = 600.0  # s
RECIPE_IN_HAND = DoorRecipe(run_id="first", door_id="some_door", width=0.826, height=2.04, thickness=0.04)


class Unreachable:
    """Stands for a library whose attempt to reach a camera lasts until it is let go of."""

    def __init__(self) -> None:
        self.let_go = threading.Event()
        self.asked = threading.Event()
        self.Camera = self

    def new(self, _address: str | None) -> Any:
        self.asked.set()
        self.let_go.wait(NEVER)
        raise TimeoutError("nobody answers")


@pytest.fixture
def library() -> Iterator[Unreachable]:
    library = Unreachable()
    yield library
    library.let_go.set()


def test_the_shipped_limit_lies_below_that_of_the_bridge() -> None:
    own, bridge = (
        next(p.default for p in node.PARAMETERS if p.name == name)
        for node, name in ((GigeCamera, "limit"), (AbbBridge, "limit.picture"))
    )
    assert own <= bridge - 1.0


def test_a_door_is_answered_while_the_library_waits(context: rclpy.Context, library: Unreachable) -> None:
    node = GigeCamera(
        Aravis(library, TimeoutError),
        context=context,
        parameter_overrides=[Parameter("limit", value=0.3), Parameter("autostart", value=False)],
    )
    told: list[DoorLocalization] = []
    listener = rclpy.create_node("listener", context=context)
    listener.create_subscription(
        topics.DOOR_LOCALIZATION.type, topics.DOOR_LOCALIZATION.name, told.append, 10
    )
    executor = SingleThreadedExecutor(context=context)
    for one in (node, listener):
        executor.add_node(one)
    node.trigger_configure()
    while not node.count_subscribers(topics.DOOR_LOCALIZATION.name):
        executor.spin_once(timeout_sec=0.1)
    node.trigger_activate()
    node._take_request(Bool(data=True))
    node._take_recipe(RECIPE_IN_HAND)
    assert library.asked.wait(NEVER)
    while not told:
        executor.spin_once(timeout_sec=0.1)
    assert not library.let_go.is_set()
    (answer,) = told
    assert (answer.run_id, answer.door_id, answer.accepted) == ("first", "some_door", False)
    assert answer.error_code == NoPictureInTime.code
    assert "the camera does not answer; check its cable" in answer.reason
    assert not node.still_wanted("first")
    node._take_result(RunResult(run_id="first"))
    library.let_go.set()
    while node._waiting.reason == SILENT:
        executor.spin_once(timeout_sec=0.1)
    node._take_recipe(DoorRecipe(run_id="second", width=0.826, height=2.04, thickness=0.04))
    while len(told) < 2:
        executor.spin_once(timeout_sec=0.1)
    assert told[1].run_id == "second"
    assert "nobody answers" in told[1].reason
    node.trigger_deactivate()
    executor.shutdown()
    node.destroy_node()
    listener.destroy_node()


def without_a_picture() -> RecordedRun:
    (run,) = read_runs(ROOT / "bags" / "outside_y")
    ((recorded_ns, message),) = run.localizations
    message.error_code, message.reason = NoPictureInTime.code, "no picture of the door came within 8 s: gone"
    run.localizations = [(recorded_ns, message)]
    run.pictures.clear()
    run.result.error_code = NoPictureInTime.code
    run.result.message = f"door {run.door_id}: {message.reason}"
    return run


def test_its_run_is_replayed_as_far_as_it_goes() -> None:
    run = without_a_picture()
    assert not repeats_the_end(run)
    offline = {a.topic: a for a in replay_offline(run)}
    assert offline[LOCALIZATION_STAGE].not_compared
    assert offline[RESULT_STAGE].error_code == NoPictureInTime.code
    live = {a.topic: a for a in replay_live(run, LiveOptions(rate=math.inf))}
    assert live.keys() == {RECIPE_STAGE, LOCALIZATION_STAGE, RESULT_STAGE}
    assert live[LOCALIZATION_STAGE].values["error_code"] == NoPictureInTime.code
    assert live[LOCALIZATION_STAGE].not_compared
    assert live[RESULT_STAGE].not_compared
