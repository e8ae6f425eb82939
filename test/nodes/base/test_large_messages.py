"""A picture fits whole into what its sender shares with other processes."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

from doormill_ros.nodes.process.dds_settings import make_room_for_pictures

PICTURE = 1920 * 1080
NAMES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
SPACE = {"dds": "http://www.eprosima.com"}


def test_the_shared_memory_holds_pictures_under_way(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in NAMES:
        monkeypatch.setenv(name, "")  # so that it is put back afterwards
        monkeypatch.delenv(name)
    make_room_for_pictures()
    settings = ElementTree.parse(Path(os.environ[NAMES[0]]))
    (size,) = settings.iterfind(".//dds:segment_size", SPACE)
    assert int(size.text) >= 3 * PICTURE
    used = [element.text for element in settings.iterfind(".//dds:userTransports/dds:transport_id", SPACE)]
    described = settings.iterfind(".//dds:transport_descriptor/dds:transport_id", SPACE)
    assert used == [element.text for element in described]


@pytest.mark.parametrize("name", NAMES)
def test_settings_of_the_user_are_left_alone(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    for each in NAMES:
        monkeypatch.setenv(each, "")
        monkeypatch.delenv(each)
    monkeypatch.setenv(name, "mine.xml")
    make_room_for_pictures()
    assert [os.environ.get(each) for each in NAMES] == [
        "mine.xml" if each == name else None for each in NAMES
    ]
