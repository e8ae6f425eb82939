"""The parameter with which nodes are told of other sensors than those of config/cell.yaml."""

from __future__ import annotations

from doormill_ros.nodes.base.node_parameter import NodeParameter

SENSORS_PARAMETER = NodeParameter(
    "sensors",
    "",
    "what finds the door, names with commas, the first one mills; empty: those of config/cell.yaml",
)
