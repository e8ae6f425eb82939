"""What an executable of nodes says on --help, and which words of its command line are ROS 2's."""

from __future__ import annotations

import inspect
import json
import sys
import textwrap
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, cast

from doormill_ros.nodes.base.managed_node import AUTOSTART, ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.resources import resource

NODES_FILE = "config/nodes.yaml"  #: parameters that every executable is started with
HELP = ("-h", "--help")
_FLAG, _END = "--ros-args", "--"
_WIDTH = 100  # characters of a line


def words_apart(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """The words of a command line that are nobody's but the executable's, and those of ROS 2.

    Args:
        arguments: Without the name of the program. What is ROS 2's begins with --ros-args and ends with -- or the line.
    """
    own: list[str] = []
    of_ros: list[str] = []
    inside = False
    for word in arguments:
        inside = inside or word == _FLAG
        (of_ros if inside else own).append(word)
        inside = inside and word != _END
    return own, of_ros


def help_page(program: str, factories: Sequence[Callable[[], ManagedNode]]) -> str:
    """What the nodes of an executable are, what their parameters mean, and how to give them.

    Args:
        program: How the executable is called.
        factories: Make its nodes.
    """
    usage = f"usage: {program} [--ros-args [-p NAME:=VALUE] [-r NAME:=OTHER_NAME] [--params-file FILE] ...]"
    return f"{usage}\n{parameters_page(factories)}"


def parameters_page(factories: Sequence[Callable[[], ManagedNode]]) -> str:
    """The page's part on the nodes that `factories` make."""
    kinds = dict.fromkeys(_kind(factory) for factory in factories)
    lines = [line for kind in kinds for line in _told(kind)]
    lines += ["", *_wrapped(f"Shown are the defaults; what {resource(NODES_FILE)} says goes before them.")]
    return "\n".join(lines)


def _kind(factory: Any) -> type[ManagedNode]:
    made: Any = factory.func if isinstance(factory, partial) else factory
    return cast("type[ManagedNode]", made)


def _told(kind: type[ManagedNode]) -> list[str]:
    """The lines on one kind of node."""
    about = [sys.modules[kind.__module__].__doc__, kind.__doc__]
    lines = [
        "",
        *(line for text in about for line in _wrapped(inspect.cleandoc(text or ""))),
        "",
        "parameters:",
    ]
    for parameter in (*kind.PARAMETERS, AUTOSTART):
        lines.append(f"  {parameter.name}:={_as_given(parameter.default)}")
        lines += _wrapped(f"{parameter.description}; allowed is {_allowed(parameter)}", "      ")
    return lines


def _allowed(parameter: NodeParameter) -> str:
    when = "" if parameter.live else ", read when the node is configured"
    return f"{parameter.allowed}{when}"


def _as_given(value: Any) -> str:
    """As it stands on a command line, in YAML."""
    return "''" if value == "" else value if isinstance(value, str) else json.dumps(value)


def _wrapped(text: str, indent: str = "") -> list[str]:
    return [
        line
        for part in text.splitlines()
        for line in textwrap.wrap(part, _WIDTH, initial_indent=indent, subsequent_indent=indent) or [""]
    ]
