"""A few doors of `bench/afternoon.py`, a fault of each kind of hand with them."""

from __future__ import annotations

import threading
from collections import Counter
from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.cell.run.waiting import wait
from doormill_ros.nodes.simulated.controller_simulator import switch_on
from support.afternoon.campaign import Tally, play
from support.afternoon.cell import CREDENTIALS
from support.afternoon.faults import KINDS, Fault, draw
from support.waiting import LIMIT

#: Of what the campaign of deaths does not play: wire, clock, clamp, camera, disk.
FAULTS = [
    Fault("network of the controller cut", "abb_bridge", "targets", 0.0, 2.0, 0.0),
    Fault("clock set", "abb_bridge", "picture", 0.0, 0.2, 3600.0),
    Fault("clamp opened", "abb_bridge", "targets", 0.0, 0.5, 0.0),
    Fault("camera pulled", "abb_bridge", "recipe", 0.0, 2.0, 0.0),
    Fault("folder of target files gone", "abb_bridge", "recipe", 0.0, 2.0, 0.0),
]


def test_each_door_of_a_bad_afternoon_has_a_result_and_no_door_is_milled_for_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in {**CREDENTIALS, "ROS_LOG_DIR": str(tmp_path / "ros")}.items():
        monkeypatch.setenv(name, value)
    said: list[str] = []
    tally = play(tmp_path / "cell", FAULTS, said.append)
    assert tally.troubles() == []
    assert tally.doors == len(said) == len(FAULTS)
    assert tally.milled + tally.refused.total() == tally.doors
    assert tally.seen >= 6  # each of three doors before and after the faults
    assert tally.places > 1


def test_an_opened_clamp_takes_the_request_back(tmp_path: Path) -> None:
    cell = switch_on(tmp_path / "HOME")
    run = cell.start("oak")
    program = threading.Thread(target=run.execute, daemon=True)
    program.start()
    waiting = threading.Condition()
    try:
        assert wait(waiting, lambda: cell.io.read(signals.REQUEST), LIMIT)
        run.open_clamp()
        assert wait(waiting, lambda: not cell.io.read(signals.REQUEST), LIMIT)
    finally:
        run.stop()
        program.join(LIMIT)
    assert not program.is_alive()


def test_a_trouble_of_each_kind_is_told() -> None:
    lists = ("wrong", "without_result", "unforeseen", "not_seen", "not_on_page", "left", "manual", "died")
    for name in lists:
        assert Tally(**{name: ["door oak"]}).troubles() == ["door oak"]
    assert Tally(doors=3, milled=1, refused=Counter({808: 2})).troubles() == []


def test_faults_are_drawn_by_the_seed_and_each_kind_comes_as_often() -> None:
    drawn = [draw(1, index) for index in range(10 * len(KINDS))]
    assert drawn == [draw(1, index) for index in range(len(drawn))]
    assert drawn != [draw(2, index) for index in range(len(drawn))]
    assert Counter(fault.kind for fault in drawn) == dict.fromkeys(KINDS, 10)
