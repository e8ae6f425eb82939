"""The node: what it records of a running system, and what it says of itself."""

from __future__ import annotations

import array
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Thread
from types import SimpleNamespace
from typing import Any

import pytest
import rclpy
import yaml
from action_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.action import ActionServer
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosbags.rosbag2 import Reader
from std_msgs.msg import Bool

from doormill_interfaces.action import MillDoor
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.rebuild import rebuild
from doormill_ros.cell.errors import BadParameterError
from doormill_ros.nodes.bag_recorder import BagRecorder
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.nodes.process.spinning import SteadyExecutor
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.software import software
from support.waiting import LIMIT

SMALLEST_QUEUE = 1 << 20  # bytes


class Recording:
    """A recorder and a node beside it, spinning."""

    def __init__(self, folder: Path, /, **parameters: Any) -> None:
        rclpy.init()
        overrides = {"bag": str(folder), **parameters}
        self.recorder = BagRecorder(parameter_overrides=[Parameter(k, value=v) for k, v in overrides.items()])
        self.node = Node("beside")
        self.executor = SteadyExecutor(3)
        self.executor.add_node(self.recorder)
        self.executor.add_node(self.node)
        self.thread = Thread(target=self.executor.spin, daemon=True)
        self.thread.start()

    def publisher(self, topic: topics.Topic) -> Any:
        publisher = self.node.create_publisher(topic.type, topic.name, topic.offered)
        self.wait(lambda: publisher.get_subscription_count() >= 1)
        return publisher

    def wait(self, condition: Callable[[], Any]) -> None:
        deadline = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < deadline, "waited in vain"
            time.sleep(0.02)

    def close(self) -> None:
        self.recorder.close()
        self.executor.shutdown(timeout_sec=2.0)
        rclpy.try_shutdown()
        self.thread.join(2.0)


@pytest.fixture
def record(tmp_path: Path) -> Iterator[Callable[..., Recording]]:
    made: list[Recording] = []

    def make(**parameters: Any) -> Recording:
        made.append(Recording(tmp_path / "bag", **parameters))
        made[-1].recorder.bring_up()
        return made[-1]

    yield make
    for recording in made:
        recording.close()


def test_latched_state_and_the_last_message_are_in_the_bag(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(autostart=False)
    early = recording.node.create_publisher(Bool, topics.ABB_READY.name, topics.ABB_READY.offered)
    early.publish(Bool(data=True))
    recording.recorder.trigger_configure()
    recording.recorder.trigger_activate()
    publisher = recording.publisher(topics.ABB_REQUEST)
    for number in range(20):
        publisher.publish(Bool(data=number % 2 == 1))
        time.sleep(0.002)
    recording.recorder.close()
    found = [(m.topic, m.message.data) for m in read_bag(tmp_path / "bag", ["/abb/ready", "/abb/request"])]
    assert found.count(("/abb/ready", True)) == 1
    # What was latched may be handed over after what came later.
    assert [data for topic, data in found if topic == "/abb/request"] == 10 * [False, True]
    with Reader(tmp_path / "bag") as reader:
        (ready,) = (c for c in reader.connections if c.topic == "/abb/ready")
        assert ready.ext.offered_qos_profiles[0].durability.name == "TRANSIENT_LOCAL"


@pytest.mark.parametrize(
    "topic",
    [
        topics.IMAGE,
        topics.CAMERA_INFO,
        topics.SENSOR_READING,
        topics.DOOR_POSE,
        topics.DOOR_LOCALIZATION,
        topics.SENSOR_LOCALIZATION,
        topics.PATH_TARGETS,
    ],
    ids=lambda topic: topic.name,
)
def test_what_is_told_of_a_run_before_dds_knows_the_recorder_is_in_the_bag(
    record: Callable[..., Recording], tmp_path: Path, topic: topics.Topic
) -> None:
    recording = record()
    context = rclpy.Context()  # of a node that starts, which knows nobody yet
    rclpy.init(context=context)
    publisher = Node("starting", context=context).create_publisher(topic.type, topic.name, topic.offered)
    publisher.publish(topic.type())
    name = f"/{topic.name}"
    recording.wait(lambda: publisher.get_subscription_count() >= 1)
    publisher.publish(topic.type())
    assert publisher.wait_for_all_acked()
    recording.recorder.close()
    rclpy.shutdown(context=context)
    assert len(list(read_bag(tmp_path / "bag", [name]))) == 2
    with Reader(tmp_path / "bag") as reader:
        (found,) = (c for c in reader.connections if c.topic == name)
        assert found.ext.offered_qos_profiles[0].durability.name == "VOLATILE"


def test_what_does_not_fit_is_counted_and_told(record: Callable[..., Recording], tmp_path: Path) -> None:
    recording = record(queue_size=SMALLEST_QUEUE)
    told: list[DiagnosticStatus] = []
    recording.node.create_subscription(
        DiagnosticArray, "/diagnostics", lambda m: told.extend(m.status), topics.DIAGNOSTICS.requested
    )
    publisher = recording.publisher(topics.IMAGE)
    picture = topics.IMAGE.type(data=array.array("B", bytes(SMALLEST_QUEUE + 1)))
    publisher.publish(picture)
    recording.wait(lambda: any("1 of /camera/image_raw" in s.message for s in told))
    status = next(s for s in told if "1 of /camera/image_raw" in s.message)
    assert status.level == DiagnosticStatus.WARN
    assert ("dropped", "1") in [(v.key, v.value) for v in status.values]
    recording.recorder.close()
    document = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert document["custom_data"].items() >= {"dropped": "1", "dropped /camera/image_raw": "1"}.items()


def test_runs_are_noted_in_the_catalogue_as_they_end(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    url = str(tmp_path / "runs.sqlite")
    recording = record(catalogue=url)
    publishers = [recording.publisher(topic) for topic in (topics.DOOR_RECIPE, topics.RUN_RESULT)]
    publishers[0].publish(topics.DOOR_RECIPE.type(run_id="run_1", door_id="door_1", version=3, document="{}"))
    # The result goes another way: what is noted with it has to be there first.
    recording.wait(lambda: recording.recorder._writer.record.topics["/door/recipe"].message_count)
    publishers[1].publish(topics.RUN_RESULT.type(run_id="run_1", door_id="door_1", error_code=407))
    recording.wait((tmp_path / "runs.sqlite").exists)
    with Catalogue(url) as catalogue:
        recording.wait(lambda: list(catalogue.rows()))
        (noted,) = catalogue.rows()
        assert (noted.run.recipe_version, noted.run.error_code, noted.run.bag_sha256) == (3, 407, "")
        recording.recorder.close()
        (closed,) = catalogue.rows()
        assert closed.run.bag_sha256 != ""
        assert closed.run.software == software()
        assert closed.run.cell == socket.gethostname()
    with Catalogue(str(tmp_path / "again.sqlite")) as again:
        assert [found.runs for found in rebuild(again, [tmp_path])] == [1]
        assert list(again.rows()) == [closed]


def test_a_catalogue_that_is_away_is_told_and_costs_no_message(
    record: Callable[..., Recording], tmp_path: Path
) -> None:
    recording = record(catalogue=str(tmp_path))
    told: list[DiagnosticStatus] = []
    recording.node.create_subscription(
        DiagnosticArray, "/diagnostics", lambda m: told.extend(m.status), topics.DIAGNOSTICS.requested
    )
    publisher = recording.publisher(topics.RUN_RESULT)
    publisher.publish(topics.RUN_RESULT.type(run_id="run_1"))
    recording.wait(
        lambda: [s for s in told if "catalogue rebuild" in s.message and s.level == DiagnosticStatus.WARN]
    )
    recording.recorder.close()
    (message,) = read_bag(tmp_path / "bag", ["/run/result"])
    assert message.message.run_id == "run_1"


def test_what_dds_lost_is_counted_too(record: Callable[..., Recording], tmp_path: Path) -> None:
    recording = record()
    recording.wait(lambda: recording.recorder.active)
    recording.recorder._count_lost("/camera/image_raw", SimpleNamespace(total_count_change=2))
    recording.recorder.close()
    document = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert document["custom_data"]["dropped /camera/image_raw"] == "2"


def test_excluded_topics_are_left_out(record: Callable[..., Recording], tmp_path: Path) -> None:
    recording = record(exclude="abb/request door/overlay")
    recording.publisher(topics.ABB_READY).publish(Bool(data=True))
    request = recording.node.create_publisher(Bool, topics.ABB_REQUEST.name, topics.ABB_REQUEST.offered)
    request.publish(Bool(data=True))
    # A look for new topics that finds this one has seen the one that is left out.
    late = recording.node.create_publisher(Bool, "late", 1)
    recording.wait(late.get_subscription_count)
    assert request.get_subscription_count() == 0
    recording.wait(lambda: recording.recorder._writer.record.topics["/abb/ready"].message_count)
    recording.recorder.close()
    assert [m.topic for m in read_bag(tmp_path / "bag") if m.topic.startswith("/abb")] == ["/abb/ready"]


FEEDBACK, STATUS = "/mill_door/_action/feedback", "/mill_door/_action/status"


def serve(recording: Recording) -> ActionServer:
    """An action that tells two stages of each goal."""

    def execute(goal: Any) -> MillDoor.Result:
        for stage in ("picture", "milling"):
            goal.publish_feedback(MillDoor.Feedback(stage=stage))
        goal.succeed()
        return MillDoor.Result(success=True)

    return ActionServer(recording.node, MillDoor, "mill_door", execute)


def is_recorded(recording: Recording, topic: str) -> bool:
    infos = recording.node.get_subscriptions_info_by_topic(topic)
    return "bag_recorder" in [info.node_name for info in infos]


def test_what_an_action_publishes_is_recorded(record: Callable[..., Recording], tmp_path: Path) -> None:
    recording = record(include_hidden_topics=True)
    server = serve(recording)
    client = GoalClient(recording.node, MillDoor, "mill_door")
    recording.wait(lambda: is_recorded(recording, FEEDBACK) and is_recorded(recording, STATUS))
    recording.wait(client.server_is_ready)
    sent = client.send_goal_async(MillDoor.Goal(door_id="any"))
    recording.wait(sent.done)
    ended = sent.result().get_result_async()
    recording.wait(ended.done)
    recording.recorder.close()
    server.destroy()
    recorded = list(read_bag(tmp_path / "bag", [FEEDBACK, STATUS]))
    told = [m.message for m in recorded if m.topic == FEEDBACK]
    assert [m.feedback.stage for m in told] == ["picture", "milling"]
    assert {bytes(m.goal_id.uuid) for m in told} == {bytes(sent.result().goal_id.uuid)}
    last = next(m.message for m in reversed(recorded) if m.topic == STATUS)
    assert [status.status for status in last.status_list] == [GoalStatus.STATUS_SUCCEEDED]
    with Reader(tmp_path / "bag") as reader:
        (status,) = (c for c in reader.connections if c.topic == STATUS)
        assert status.ext.offered_qos_profiles[0].durability.name == "TRANSIENT_LOCAL"


def test_as_ros2_bag_does_it_leaves_hidden_topics_out_unless_told(record: Callable[..., Recording]) -> None:
    recording = record()
    server = serve(recording)
    later = recording.node.create_publisher(Bool, "found_later", topics.EVENT)
    recording.wait(lambda: is_recorded(recording, later.topic_name))
    assert recording.node.count_publishers(FEEDBACK) == 1
    assert not is_recorded(recording, FEEDBACK)
    assert not is_recorded(recording, STATUS)
    server.destroy()


@pytest.mark.parametrize("parameter", ["bag", "folder"])
def test_a_folder_that_cannot_be_made_is_one_sentence(
    record: Callable[..., Recording], capfd: pytest.CaptureFixture[str], tmp_path: Path, parameter: str
) -> None:
    (tmp_path / "file").touch()
    place = tmp_path / "file" / "below"
    recording = record(**{"autostart": False, "bag": "", "catalogue": "none", parameter: str(place)})
    assert recording.recorder.trigger_configure() == TransitionCallbackReturn.FAILURE
    assert recording.recorder.trigger_configure() == TransitionCallbackReturn.FAILURE
    said = capfd.readouterr().err
    assert "Traceback" not in said
    assert said.count("could not configure") == 1  # however often it is tried
    assert f"could not configure: nothing can be recorded into {place}: Not a directory; " in said
    assert f"correct the parameter {parameter}, or make way" in said
    assert recording.recorder._health[2] == {"error_code": BadParameterError.code}
    # Once there is room, it is made.
    (tmp_path / "file").unlink()
    assert recording.recorder.trigger_configure() == TransitionCallbackReturn.SUCCESS
