"""A goal that is meant for another server of mill_door is refused, and nothing of it remains."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.errors import NodeInactiveError, WrongGoalError
from doormill_ros.cell.run.run_in_hand import NOTE
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.door_shares import DoorShares
from support.hostile.listeners import Listener


def asked(node: ManagedNode, run_id: str) -> MillDoor.Result:
    """What a goal is told that names a run, or none."""
    goal = SimpleNamespace(
        request=MillDoor.Goal(door_id="thesis_190_0deg", run_id=run_id),
        is_cancel_requested=False,
        abort=lambda: None,
    )
    runs = node._runs if isinstance(node, DoorShares) else node._action._runs
    return runs._execute(goal)


@pytest.mark.parametrize("kind", [AbbBridge, DoorShares])
def test_who_mills_whole_doors_takes_no_share(context, tmp_path: Path, kind: type[ManagedNode]) -> None:
    node = Listener(kind).up(context, tmp_path)
    told = asked(node, "20261130T120000000000Z")
    assert told.error_code == WrongGoalError.code
    assert "leave the run out" in told.message
    assert list(tmp_path.rglob(NOTE)) == []
    node.close()
    node.destroy_node()


@pytest.mark.parametrize("kind", [AbbBridge, DoorShares])
def test_a_node_that_rests_says_so(context, tmp_path: Path, kind: type[ManagedNode]) -> None:
    node = Listener(kind).up(context, tmp_path)
    node.trigger_deactivate()
    told = asked(node, "")
    assert told.error_code == NodeInactiveError.code
    assert f"/{node.get_name()} is not active" in told.message
    node.close()
    node.destroy_node()
