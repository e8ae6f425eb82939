"""No run is left without a result by a bridge that ends in the middle of it, whether it was killed or told to end."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest

from doormill_interfaces.action import MillDoor
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.errors import NodeDeadError, RunCutOffError
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.goal_client import GoalClient
from support.cell_processes import CellProcesses
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    with CellProcesses(tmp_path_factory.mktemp("cell")) as running:
        yield running


ENDS = pytest.mark.parametrize(
    "how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL], ids=lambda how: how.name
)


@ENDS
@pytest.mark.parametrize(
    ("state", "codes"),
    [
        ("", {RunCutOffError.code}),
        # It may have heard of the end, or have to leave to the robot what it was at.
        (HandshakeState.MILLING.value, {0, RunCutOffError.code}),
    ],
    ids=["no picture yet", "milling"],
)
def test_the_next_one_tells_how_the_run_ended(
    cell: CellProcesses, how: signal.Signals, state: str, codes: set[int]
) -> None:
    """A service that is restarted is told to end, and then can tell nobody anything any more."""
    recipes, results = cell.subscribe(topics.DOOR_RECIPE), cell.subscribe(topics.RUN_RESULT)
    told = cell.subscribe(topics.ABB_STATUS)
    before, _ = cell.mill(DOOR)
    assert before.success, before.message
    localizer = cell.processes["door_localizer"]
    if not state:
        localizer.send_signal(signal.SIGSTOP)
    goal = GoalClient(cell.node, MillDoor, "mill_door")
    assert goal.wait_for_server(LIMIT)
    goal.send_goal_async(MillDoor.Goal(door_id=DOOR))
    run = cell.wait(lambda: next((m.run_id for m in recipes if m.run_id > before.run_id), None))  # ids grow
    if state:
        cell.wait(lambda: any(m.run_id == run and m.state == state for m in told))
    cell.stop("abb_bridge", how)
    localizer.send_signal(signal.SIGCONT)
    cell.start("abb_bridge")
    ended = cell.wait(lambda: next((m for m in results if m.run_id == run), None))
    assert ended.door_id == DOOR
    assert ended.error_code in codes, ended.message
    cell.wait_until_up()
    # The bridge hears of the others a moment later than this process.
    result = cell.wait(lambda: (ended := cell.mill(DOOR)[0]).error_code != NodeDeadError.code and ended)
    assert result.success, result.message
