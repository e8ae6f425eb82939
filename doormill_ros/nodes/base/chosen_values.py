"""Judge values of parameters before there is a node, as the node would when it declares them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import AT_START, ReportingNode


def check_values(node: str, kind: type[ReportingNode], values: Mapping[str, object]) -> None:
    """Judge what a node is to be started with; names that it does not have are not judged.

    Args:
        node: Its name.
        kind: Its class.
        values: By the parameters' names.

    Raises:
        BadParameterError: The node would not take one of them.
    """
    declared = {parameter.name: parameter for parameter in kind.PARAMETERS}
    for name, value in values.items():
        if name in declared and not _is_taken(declared[name], value):
            raise BadParameterError(declared[name].refusal(node, value, AT_START))


def _is_taken(parameter: NodeParameter, value: object) -> bool:
    kind = type(parameter.default)
    if isinstance(value, Path):
        value = str(value)
    if kind is float and type(value) is int:
        value = float(value)
    if type(value) is not kind or (parameter.choices and value not in parameter.choices):
        return False
    if parameter.low is None or parameter.high is None or not isinstance(value, int | float):
        return True
    return parameter.low <= value <= parameter.high  # nan is not
