"""No run is left without a result by who shares doors among two robots and ends in the middle of it."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.errors import RunCutOffError
from doormill_ros.cell.graph.node_names import DOOR_SHARES
from doormill_ros.cell.run.run_in_hand import RunNote
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.goal_client import GoalClient
from support.cell_processes import CellProcesses
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"


@pytest.fixture(scope="module")
def shares(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    """The node that shares doors among two robots, of which none is there, so that it waits."""
    folder = tmp_path_factory.mktemp("shares")
    with CellProcesses(folder, {DOOR_SHARES: {"note": folder}}, ["recipe_database", DOOR_SHARES]) as running:
        running.wait_until_active(DOOR_SHARES)
        yield running


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL], ids=lambda how: how.name)
def test_who_shares_a_door_among_two_robots_tells_it_too(shares: CellProcesses, how: signal.Signals) -> None:
    results, note = shares.subscribe(topics.RUN_RESULT), RunNote(shares.folder)
    goal = GoalClient(shares.node, MillDoor, "mill_door")
    assert goal.wait_for_server(LIMIT)
    goal.send_goal_async(MillDoor.Goal(door_id=DOOR))
    run, door = shares.wait(note.read)
    shares.stop(DOOR_SHARES, how)
    shares.start(DOOR_SHARES)
    ended = shares.wait(lambda: next((m for m in results if m.run_id == run), None))
    assert (ended.door_id, ended.error_code) == (door, RunCutOffError.code) == (DOOR, RunCutOffError.code)
    assert "both robots" in ended.message
    assert shares.wait(lambda: note.read() is None)
    shares.wait_until_active(DOOR_SHARES)
