"""What a node's messages lose on the wire is sent again soon."""

from __future__ import annotations

import os
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from doormill_ros.nodes.process.dds_settings import make_room_for_pictures, repair_soon

NAMES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
SPACE = {"dds": "http://www.eprosima.com"}
PERIOD = ".//dds:data_writer[@is_default_profile='true']/dds:times/dds:heartbeat_period"
#: A door's stages take some tens of milliseconds; by default it is three seconds [ns].
LONGEST = 100_000_000
STARTS = """
import os
import rclpy
from doormill_ros.nodes.process.run import init
init(["some_node"])
rclpy.create_node("some_node")
print(os.environ["FASTDDS_DEFAULT_PROFILES_FILE"], flush=True)
rclpy.shutdown()
"""


@pytest.fixture(autouse=True)
def no_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in NAMES:
        monkeypatch.setenv(name, "")  # so that it is put back afterwards
        monkeypatch.delenv(name)


def heartbeat_of(file: str) -> int:
    """[ns]"""
    (period,) = ElementTree.parse(file).iterfind(PERIOD, SPACE)
    seconds, nanoseconds = (int(period.find(f"dds:{name}", SPACE).text) for name in ("sec", "nanosec"))
    return seconds * 1_000_000_000 + nanoseconds


def test_a_node_s_process_takes_settings_that_fast_dds_understands() -> None:
    done = subprocess.run([sys.executable, "-c", STARTS], capture_output=True, text=True, check=True)
    assert heartbeat_of(done.stdout.strip()) <= LONGEST
    assert "XMLPARSER" not in done.stdout + done.stderr


def test_who_sends_pictures_repairs_as_soon() -> None:
    make_room_for_pictures()
    assert heartbeat_of(os.environ[NAMES[0]]) <= LONGEST


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
