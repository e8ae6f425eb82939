"""A goal that comes to its turn when the bridge has been cleaned up."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import rclpy

from doormill_ros.cell.errors import NodeInactiveError
from doormill_ros.nodes.abb_bridge import AbbBridge


def test_it_is_told_to_configure_the_bridge(context: rclpy.Context) -> None:
    bridge = AbbBridge(context=context)
    try:
        with pytest.raises(NodeInactiveError, match="cleaned up; configure and activate it"):
            bridge._action._mill(SimpleNamespace(run_id="run"), lambda *_: None)
    finally:
        bridge.close()
        bridge.destroy_node()
