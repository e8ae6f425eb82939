"""Who serves runs waits for their stages as long as the domain says, whether one robot mills or two."""

from __future__ import annotations

from dataclasses import fields

import pytest

from doormill_ros.cell.run.run import StageLimits
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.door_shares import DoorShares

STAGES = [stage.name for stage in fields(StageLimits)]


def limit(node: type[ManagedNode], stage: str) -> NodeParameter:
    (found,) = [one for one in node.PARAMETERS if one.name == f"limit.{stage}"]
    return found


@pytest.mark.parametrize("stage", STAGES)
def test_one_robot_is_waited_for_as_long_as_two(stage: str) -> None:
    alone, shared = limit(AbbBridge, stage), limit(DoorShares, stage)
    assert alone.default == shared.default == getattr(StageLimits(), stage)
    assert (alone.low, alone.high) == (shared.low, shared.high)
    assert shared.live
    assert alone.live == (stage not in ("read", "milling"))
