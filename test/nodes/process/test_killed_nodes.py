"""A node that dies ends the run with its name, and another one takes its place."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from typing import Any

import pytest

from doormill_ros.cell.errors import NodeDeadError
from doormill_ros.nodes.base.alive import LEASE
from support.cell_processes import CellProcesses

DOOR = "thesis_190_0deg"


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    parameters = {"abb_bridge": {"limit.sign_of_life": LEASE}}
    with CellProcesses(tmp_path_factory.mktemp("cell"), parameters) as running:
        # Whom the bridge never heard of it cannot miss, and it may hear of a node later than this process does.
        running.wait(lambda: running.mill(DOOR)[0].success)
        yield running


@pytest.mark.parametrize("node", ["door_localizer", "path_generator", "recipe_database", "cell_simulator"])
def test_a_killed_node_ends_the_run_with_a_reason_and_is_replaced(cell: CellProcesses, node: str) -> None:
    cell.stop(node, signal.SIGKILL)

    def refused() -> Any:
        """A loaded machine may keep back the signs of life of others, too, for a moment."""
        ended, _ = cell.mill(DOOR)
        assert not ended.success
        assert ended.error_code == NodeDeadError.code
        assert ended.target_file == ""
        return node.removeprefix("cell") in ended.message

    try:
        assert cell.wait(refused)
    finally:
        cell.start(node)
    cell.wait_until_up()
    # The bridge hears of the new node a moment later than this process.
    result = cell.wait(lambda: (ended := cell.mill(DOOR)[0]).error_code != NodeDeadError.code and ended)
    assert result.success, result.message
