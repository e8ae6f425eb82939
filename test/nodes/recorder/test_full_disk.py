"""A recorder whose disk is full goes on, says so, and knows what it lost."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
import yaml

from doormill_ros.recording.bag_reader import read_bag
from support.source_tree import ROOT
from support.waiting import LIMIT

FILE_SIZE = 950_000  # bytes that one file may have
PICTURE = 100_000  # bytes that do not compress
PICTURE_TOPIC = "/camera/image_raw"
#: The system refuses to let any file of this process grow further, as a full disk would.
RECORDER = """
import array, json, random, resource, sys, time
from threading import Thread
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.parameter import Parameter
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.bag_recorder import BagRecorder
from doormill_ros.nodes.process.spinning import SteadyExecutor

folder, size, limit = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
rclpy.init()
recorder = BagRecorder(parameter_overrides=[Parameter("bag", value=folder)])
node = Node("beside")
executor = SteadyExecutor(3)
executor.add_node(recorder)
executor.add_node(node)
spinning = Thread(target=executor.spin, daemon=True)
spinning.start()
recorder.bring_up()
told = []
node.create_subscription(
    DiagnosticArray, "/diagnostics", lambda m: told.extend(m.status), topics.DIAGNOSTICS.requested
)
publisher = node.create_publisher(topics.IMAGE.type, topics.IMAGE.name, topics.IMAGE.offered)

def wait(condition):
    deadline = time.monotonic() + 300.0
    while not condition():
        if time.monotonic() > deadline:
            sys.exit("waited in vain")
        time.sleep(0.01)

def known():
    written = recorder._writer.record.topics["/camera/image_raw"].message_count
    return written + recorder._queue.dropped.get("/camera/image_raw", 0)

def send(number):
    data = random.Random(number).randbytes(size)
    publisher.publish(topics.IMAGE.type(width=number, data=array.array("B", data)))
    wait(lambda: known() == number)

wait(lambda: publisher.get_subscription_count() >= 1)
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
sent = 0
while not any(s.level == b"\\x02" for s in told) and sent < 200:
    sent += 1
    send(sent)
    time.sleep(0.05)
for _ in range(3):
    sent += 1
    send(sent)
faults = [s.message for s in told if s.level == b"\\x02"]
heard = len(told)
wait(lambda: len(told) > heard + 1)
print(json.dumps({"sent": sent, "fault": faults[0] if faults else "", "active": recorder.active}))
recorder.close()
executor.shutdown(timeout_sec=30.0)
spinning.join(30.0)
for each in (recorder, node):
    each.destroy_node()
rclpy.try_shutdown()
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict]:
    """A bag whose disk became full, and what the recorder's process said."""
    folder = tmp_path_factory.mktemp("full") / "bag"
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", RECORDER, str(folder), str(PICTURE), str(FILE_SIZE)],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=LIMIT,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return folder, json.loads(done.stdout.splitlines()[-1])


def test_the_node_lives_on_and_reports_an_error(recorded: tuple[Path, dict]) -> None:
    _, said = recorded
    assert said["active"]
    assert "the bag cannot be written" in said["fault"]
    assert f"of {PICTURE_TOPIC}" in said["fault"]
    assert "free the disk" in said["fault"]


def test_every_picture_is_in_the_bag_or_counted_as_dropped(recorded: tuple[Path, dict]) -> None:
    folder, said = recorded
    found = [m.message.width for m in read_bag(folder, [PICTURE_TOPIC])]
    assert found == list(range(1, len(found) + 1))
    assert len(found) >= 1
    document = yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    dropped = int(document["custom_data"][f"dropped {PICTURE_TOPIC}"])
    assert dropped >= 3
    assert len(found) + dropped == said["sent"]


def test_the_metadata_counts_what_can_be_read(recorded: tuple[Path, dict]) -> None:
    folder, _ = recorded
    document = yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    readable = Counter(m.topic for m in read_bag(folder))
    promised = {
        t["topic_metadata"]["name"]: t["message_count"] for t in document["topics_with_message_count"]
    }
    assert {topic: count for topic, count in promised.items() if count} == dict(readable)
    assert document["message_count"] == sum(readable.values())
