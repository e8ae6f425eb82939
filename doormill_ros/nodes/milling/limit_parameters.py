"""The parameters of a node that say how long a run waits for each stage; their defaults are those of `StageLimits`."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import fields

from doormill_ros.cell.run.run import StageLimits
from doormill_ros.nodes.base.node_parameter import NodeParameter

#: What is waited for by stage, and the least and the longest that may be asked for [s].
_STAGES = {
    "recipe": ("the recipe", 0.1, 600.0),
    "picture": ("picture and door pose", 0.1, 600.0),
    "targets": ("the targets", 0.1, 600.0),
    "request": ("the controller's request", 0.1, 3600.0),
    "ready": ("the file to be written and verified", 0.1, 600.0),
    "read": ("the robot to read and check the file", 1.0, 3600.0),
    "milling": ("the end of milling", 1.0, 36000.0),
    "inspection": ("who measures the milled door, if anybody", 0.1, 3600.0),
}


def limit_parameters(at_start: Collection[str] = ()) -> tuple[NodeParameter, ...]:
    """A parameter a stage, as `RunServer.limits` reads them.

    Args:
        at_start: Stages whose limit the node takes when it is configured, and not for each run.
    """
    found = []
    for stage in fields(StageLimits):
        what, low, high = _STAGES[stage.name]
        about = f"longest wait for {what} [s]"
        live = stage.name not in at_start
        found.append(NodeParameter(f"limit.{stage.name}", stage.default, about, low, high, live=live))
    return tuple(found)
