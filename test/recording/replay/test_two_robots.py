"""A run of two robots is replayed robot by robot, each with its share from its own side of the door."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
from rclpy.serialization import serialize_message
from std_msgs.msg import String

from doormill_interfaces.msg import RunResult, TargetArray
from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.graph.two_robots import SHARE_OF, in_robot, robot_of
from doormill_ros.messages.from_message import recipe_of, transform_of
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.nodes.replay.live_replay import LiveOptions, replay_live
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.errors import SharedRunError
from doormill_ros.recording.replay.expectation import read_expectation, write_expectation
from doormill_ros.recording.replay.offline import replay_offline
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.recording.replay.replay import replay_bag
from doormill_ros.recording.replay.run_reader import read_runs
from support.source_tree import ROOT

SOURCE = ROOT / "bags" / "standard_door"
TARGETS, TARGET_FILE, RESULT = "/path/targets", "/abb/target_file", "/run/result"
NAMESPACE = "/cell1"
Message = tuple[str, Any]


def told(run: RecordedRun) -> Iterator[Message]:
    """What both robots tell of a run that was recorded of one, by topic."""
    ((_, localization),) = run.localizations
    T_base_door = transform_of(localization.pose.pose)
    for robot, share in SHARE_OF.items():
        setup = load_setup(share=share)
        planned = plan(recipe_of(run.recipe), T_base_door, setup)
        message = TargetArray(
            run_id=run.run_id,
            accepted=True,
            robot_model=setup.model_name,
            cycle_time=planned.time,
            header=localization.header,
        )
        yield f"/{robot}{TARGETS}", program_into(message, planned.program)
        text = render_target_file(planned.program, run.run_id).decode("ascii")
        yield f"/{robot}{TARGET_FILE}", String(data=text)


def shared(
    folder: Path, change: Callable[[Iterable[Message]], Iterable[Message]] = lambda found: found
) -> Path:
    """The bag as two robots would leave it, in a namespace; `change` alters what they told, and the result."""
    (run,) = read_runs(SOURCE)
    writer, last = BagWriter(folder), 0
    for item in read_bag(SOURCE):
        if item.topic not in (TARGETS, TARGET_FILE, RESULT):
            topic = item.topic if item.topic.startswith("/diagnostics") else NAMESPACE + item.topic
            writer.add_topic(topic, item.type_name)
            writer.write(topic, item.data, item.stamp_ns)
            last = item.stamp_ns
    result = RunResult(run_id=run.run_id, door_id=run.door_id, success=True, sha256=run.result.sha256)
    for topic, message in change([*told(run), (RESULT, result)]):
        package = message.__module__.split(".")[0]
        writer.add_topic(NAMESPACE + topic, f"{package}/msg/{type(message).__name__}")
        writer.write(NAMESPACE + topic, serialize_message(message), last)
    writer.close()
    return folder


def test_robots_are_called_as_their_namespaces() -> None:
    assert [in_robot(share) for share in ("first", "second")] == ["robot1", "robot2"] == list(SHARE_OF)
    for topic, robot in (
        ("/robot1/path/targets", "robot1"),
        ("/cell1/robot2/abb/target_file", "robot2"),
        ("/robot1/robot2/path/targets", "robot1"),
        ("/path/targets", ""),
        ("/robot12/path/targets", ""),
        ("/robot1/run", ""),
    ):
        assert robot_of(topic) == robot, topic


def test_each_share_is_compared_with_its_own(tmp_path: Path) -> None:
    outcome = replay_bag(shared(tmp_path / "bag"))
    assert outcome.found == []
    for robot in SHARE_OF:
        assert outcome.counts[f"/{robot}{TARGETS}"] == outcome.counts[f"/{robot}{TARGET_FILE}"] == 1
    assert TARGETS not in outcome.counts
    write_expectation(tmp_path / "bag", outcome.answers)
    assert read_expectation(tmp_path / "bag") == outcome.answers
    assert replay_bag(tmp_path / "bag").found == []


def test_a_share_of_the_other_robot_differs(tmp_path: Path) -> None:
    other = {"/robot1": "/robot2", "/robot2": "/robot1"}

    def swapped(found: Iterable[Message]) -> Iterable[Message]:
        return [(other.get(topic[:7], topic[:7]) + topic[7:], message) for topic, message in found]

    found = replay_bag(shared(tmp_path / "bag", swapped)).found
    for robot in SHARE_OF:
        assert any(one.topic == f"/{robot}{TARGETS}" and "joint_positions" in one.field for one in found)
        assert any(one.topic == f"/{robot}{TARGET_FILE}" for one in found)
    assert "made by path and correction" in str(next(one for one in found if TARGETS in one.topic))


@pytest.mark.parametrize(("robot", "share"), SHARE_OF.items())
def test_what_one_robot_refuses_ends_the_run_in_its_name(tmp_path: Path, robot: str, share: str) -> None:
    """Nothing refuses this door today, so the replay has to say that it differs, and from what."""
    reason = "hinge_1: it is out of reach"

    def refused(found: Iterable[Message]) -> Iterable[Message]:
        for topic, message in found:
            if topic == f"/{robot}{TARGETS}":
                yield (
                    topic,
                    TargetArray(
                        run_id=message.run_id,
                        header=message.header,
                        robot_model=message.robot_model,
                        error_code=310,
                        reason=reason,
                    ),
                )
            elif topic == RESULT:
                said = f"door standard_door: {share} robot: door standard_door: {reason}"
                yield topic, RunResult(run_id=message.run_id, error_code=310, message=said)
            elif TARGETS in topic:
                yield topic, message

    bag = shared(tmp_path / "bag", refused)
    found = replay_bag(bag).found
    assert {one.topic for one in found} == {f"/{robot}{TARGETS}", RESULT}
    # What is told is put together as it was recorded.
    (run,) = read_runs(bag)
    run.poses.clear()
    answers = {answer.topic: answer for answer in replay_offline(run)}
    # Without a pose both robots refuse; the recorded run names the one that was heard.
    said = "door standard_door: the bag holds no pose of this time"
    assert answers[RESULT].values["message"] == f"door standard_door: {share} robot: {said}"


def test_nodes_are_not_asked_for_two_robots(tmp_path: Path) -> None:
    (run,) = read_runs(shared(tmp_path / "bag"))
    with pytest.raises(SharedRunError, match="leave out --live"):
        replay_live(run, LiveOptions())
