"""Values that somebody gives to parameters that no node of the process has: ROS 2 takes them without a word."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from doormill_ros.nodes.reporting_node import ReportingNode

#: Declared by rclpy for each publisher and subscription that lets its quality of service be set.
_OF_RCLPY = "qos_overrides."


def unknown_parameters(nodes: Sequence[ReportingNode]) -> list[str]:
    """A sentence for each name that was given, on the command line or in a file, and that no node declares.

    What was given to all nodes of a process is known when one of them knows it.

    Args:
        nodes: All of the process.
    """
    known = sorted({name for node in nodes for name in node.declared()})
    given = dict.fromkeys(name for node in nodes for name in node.given())
    sentences = []
    for name in given:
        if name in known or name.startswith(_OF_RCLPY):
            continue
        near = difflib.get_close_matches(name, known, 1, cutoff=0.0)
        whose = ", ".join(f"/{node.get_name()}" for node in nodes if name in node.given())
        sentences.append(
            f"there is no parameter {name} of {whose}, and its value is left aside; perhaps {near[0]} is meant"
        )
    return sentences
