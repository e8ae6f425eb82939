"""Values that somebody gives to parameters or nodes that the process does not have: ROS 2 takes them without a word."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from itertools import pairwise

from doormill_ros.nodes.base.reporting_node import ReportingNode

#: One value of the command line for one node, as rcl reads it; a wildcard may stand for any.
_FOR_ONE_NODE = re.compile(r"(?P<node>[\w/]+):(?P<name>[^:*]+):=.*", re.DOTALL)

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


def unknown_nodes(arguments: Sequence[str], nodes: Sequence[ReportingNode]) -> list[str]:
    """A sentence for each value that the command line gives to a node that the process does not have.

    Files of parameters may be for other processes too; they are not looked at.

    Args:
        arguments: The command line.
        nodes: All of the process.
    """
    names = sorted(node.get_name() for node in nodes)
    known = {*names, *(node.get_fully_qualified_name() for node in nodes)}
    sentences = []
    for option, value in pairwise(arguments):
        given = _FOR_ONE_NODE.fullmatch(value) if option in ("-p", "--param") else None
        if given is None or given["node"] in known:
            continue
        near = difflib.get_close_matches(given["node"], names, 1, cutoff=0.0)
        sentences.append(
            f"there is no node {given['node']} in this process, and the value of its parameter {given['name']} is left "
            f"aside; perhaps {near[0]} is meant"
        )
    return sentences
