"""A simulated robot that hears of recipe or targets only after it has milled the door: it is measured all the same."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.node import Node

from doormill_ros.nodes.base import topics
from support.cell_processes import NODES, CellProcesses

DOOR = "thesis_190_0deg"
SIMULATOR = "cell_simulator"
HELD = {topic.name: f"held/{topic.name}" for topic in (topics.DOOR_RECIPE, topics.PATH_TARGETS)}


@contextmanager
def stranger() -> Iterator[Node]:
    """A node of which no other process knows yet."""
    context = rclpy.Context()
    context.init()
    node = Node("stranger", context=context)
    try:
        yield node
    finally:
        node.destroy_node()
        context.shutdown()


@pytest.mark.parametrize("late", [topics.PATH_TARGETS, topics.DOOR_RECIPE], ids=lambda topic: topic.name)
def test_a_door_is_measured_though_the_simulator_hears_late_by_what_it_was_milled(
    tmp_path: Path, late: topics.Topic
) -> None:
    # The simulator's node is active once it is started; the driver passes on what it is not to hear yet.
    with CellProcesses(tmp_path, nodes=[name for name in NODES if name != SIMULATOR]) as cell:
        cell.start(SIMULATOR, "-r", f"controller_simulator:{late.name}:={HELD[late.name]}")
        for name in ("controller_simulator", "camera_simulator"):
            cell.wait_until_active(name)
        status, messages = cell.subscribe(topics.ABB_STATUS), cell.subscribe(late)
        ended: list[Any] = []
        thread = threading.Thread(target=lambda: ended.append(cell.mill(DOOR)[0]))
        thread.start()
        # The robot has gone home and says so before anybody measures its door.
        cell.wait(lambda: any(message.state == "done" for message in status))
        assert not ended, ended
        with stranger() as node:
            # At once: DDS makes the two known to each other only after that.
            node.create_publisher(late.type, HELD[late.name], late.offered).publish(messages[-1])
            thread.join()
        (result,) = ended
        assert (result.error_code, result.measured) == (0, True)
