"""What a node's messages lose on the wire is sent again soon, and who missed a node hears of it soon."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from itertools import pairwise
from statistics import median
from xml.etree import ElementTree

import pytest

from doormill_ros.nodes.process.dds_settings import make_room_for_pictures, repair_soon
from doormill_ros.units import ns_to_s
from support.waiting import LIMIT

NAMES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
SPACE = {"dds": "http://www.eprosima.com"}
PERIOD = ".//dds:data_writer[@is_default_profile='true']/dds:times/dds:heartbeat_period"
ANNOUNCED = ".//dds:participant[@is_default_profile='true']/dds:rtps/dds:builtin//dds:leaseAnnouncement"
#: A door's stages take some tens of milliseconds; by default it is three seconds [ns].
LONGEST = 100_000_000
#: Nodes come up within seconds of each other; by default it is three [ns].
LONGEST_UNKNOWN = 500_000_000
STARTS = """
import os
import rclpy
from doormill_ros.nodes.process.run import init
init(["some_node"])
node = rclpy.create_node("some_node")
print(os.environ["FASTDDS_DEFAULT_PROFILES_FILE"], flush=True)
{then}
rclpy.shutdown()
"""
#: Where the last participant of this machine that is announced to would listen (DDSI-RTPS 2.2, 9.6.1.1).
PORT, OF_A_DOMAIN, OF_A_PARTICIPANT, LAST = 7410, 250, 2, 31
INITIAL = 8  #: announcements of a participant that has just come, a tenth of a second apart; there are six
AGAIN = 6  #: announcements after those


@pytest.fixture(autouse=True)
def no_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in NAMES:
        monkeypatch.setenv(name, "")  # so that it is put back afterwards
        monkeypatch.delenv(name)


def heartbeat_of(file: str, path: str = PERIOD) -> int:
    """[ns]"""
    (period,) = ElementTree.parse(file).iterfind(path, SPACE)
    seconds, nanoseconds = (int(period.find(f"dds:{name}", SPACE).text) for name in ("sec", "nanosec"))
    return seconds * 1_000_000_000 + nanoseconds


def test_a_node_s_process_takes_settings_that_fast_dds_understands() -> None:
    done = subprocess.run(
        [sys.executable, "-c", STARTS.format(then="")], capture_output=True, text=True, check=True
    )
    assert heartbeat_of(done.stdout.strip()) <= LONGEST
    assert "XMLPARSER" not in done.stdout + done.stderr


def test_who_sends_pictures_repairs_as_soon() -> None:
    make_room_for_pictures()
    assert heartbeat_of(os.environ[NAMES[0]]) <= LONGEST


def test_who_sends_pictures_announces_itself_as_soon() -> None:
    repair_soon()
    nodes = os.environ.pop(NAMES[0])
    make_room_for_pictures()
    assert heartbeat_of(os.environ[NAMES[0]], ANNOUNCED) == heartbeat_of(nodes, ANNOUNCED) <= LONGEST_UNKNOWN


def test_a_node_announces_itself_again_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    port = PORT + OF_A_DOMAIN * int(os.environ["ROS_DOMAIN_ID"]) + OF_A_PARTICIPANT * LAST
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", port))
        listener.settimeout(LIMIT)
        starts = [sys.executable, "-c", STARTS.format(then="input()")]
        with subprocess.Popen(starts, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as node:
            sender, times = b"", []
            while len(times) < INITIAL + AGAIN:
                message = listener.recv(65536)
                sender = sender or message[:20]  # protocol, version, vendor and participant
                if message.startswith(sender):
                    times.append(time.monotonic())
            node.communicate(b"\n")
    gaps = [after - before for before, after in pairwise(times[INITIAL:])]
    assert median(gaps) < 3 * ns_to_s(LONGEST_UNKNOWN)


def test_who_is_started_by_a_node_has_room_for_pictures() -> None:
    make_room_for_pictures()
    pictures = os.environ.pop(NAMES[0])
    repair_soon()
    assert os.environ[NAMES[0]] != pictures
    make_room_for_pictures()
    assert os.environ[NAMES[0]] == pictures
    repair_soon()
    assert os.environ[NAMES[0]] == pictures


@pytest.mark.parametrize("name", NAMES)
def test_settings_of_the_user_are_left_alone(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(name, "mine.xml")
    repair_soon()
    assert [os.environ.get(each) for each in NAMES] == [
        "mine.xml" if each == name else None for each in NAMES
    ]
