"""Node /controller_simulator: a door that comes while the node is stopped is not begun."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from rclpy.context import Context

from doormill_interfaces.msg import DoorPlacement
from doormill_ros.nodes.simulated.controller_simulator import ControllerSimulator
from support.hostile.listeners import Listener
from support.waiting import LIMIT

STEPS = ("before the program is loaded", "before its thread runs")


@pytest.mark.parametrize("step", STEPS)
def test_a_door_that_comes_while_the_node_stops_is_not_milled(
    step: str, context: Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = Listener(ControllerSimulator).up(context, tmp_path)
    errors: list[str] = []
    monkeypatch.setattr(node.get_logger(), "error", errors.append)
    reached, go_on = threading.Event(), threading.Event()
    load, begin = node._cell.start, threading.Thread.start

    def pause() -> None:
        reached.set()
        assert go_on.wait(LIMIT)

    def loaded(door_id: str) -> object:
        if step == STEPS[0]:
            pause()
        return load(door_id)

    def begun(thread: threading.Thread) -> None:
        if step == STEPS[1] and thread.name == "controller":
            pause()
        begin(thread)

    monkeypatch.setattr(node._cell, "start", loaded)
    monkeypatch.setattr(threading.Thread, "start", begun)
    placed = threading.Thread(
        target=node._take_placement, args=[DoorPlacement(run_id="1", door_id="thesis_190_0deg")]
    )
    stopped = threading.Thread(target=node.close)
    placed.start()
    assert reached.wait(LIMIT)
    stopped.start()
    stopped.join(0.5)  # it may wait for the door that is just begun; it must not go past it
    go_on.set()
    for thread in (placed, stopped):
        thread.join(LIMIT)
        assert not thread.is_alive()
    milling = [thread for thread in threading.enumerate() if thread.name == "controller"]
    node.destroy_node()
    assert errors == []
    assert milling == []
