"""Changes of a running node's parameters: those that are refused, and why, in one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from rclpy.parameter import Parameter


class Described(Protocol):
    """What a `NodeParameter` says of itself."""

    name: str
    default: Any
    low: float | None
    high: float | None
    live: bool
    choices: tuple[str, ...]

    def refusal(self, node: str, value: object, remedy: str) -> str:
        """Why a node cannot take a value, and what to do."""


class Changed(Protocol):
    """The node, as far as its parameters are concerned; see `ReportingNode`."""

    PARAMETERS: Sequence[Any]

    @property
    def settled(self) -> bool:
        """What is not live is read already."""

    def parameter(self, name: str) -> Described:
        """The description of one of its parameters."""

    def value(self, name: str) -> Any:
        """What a parameter is."""

    def has_parameter(self, name: str) -> bool:
        """It is declared."""

    def get_parameter(self, name: str) -> Parameter:
        """What rclpy holds of it."""

    def get_name(self) -> str:
        """Of the node."""


def refusal(node: Changed, changes: Sequence[Parameter]) -> str:
    """Why the node cannot take these changes; empty when it can."""
    for change in changes:
        reason = _bad_value(node, change) or _no_effect(node, change)
        if reason:
            return reason
    return ""


def _bad_value(node: Changed, change: Parameter) -> str:
    """It is of another type than the parameter, none of its few words or beyond its limits."""
    if not node.has_parameter(change.name):  # rclpy says so
        return ""
    parameter = node.parameter(change.name)
    if parameter.choices:
        if change.value in parameter.choices:
            return ""
        remedy = "set it to one of these"
    elif change.type_ == node.get_parameter(change.name).type_:
        if parameter.low is None or parameter.high is None or parameter.low <= change.value <= parameter.high:
            return ""
        remedy = "set it within these limits"
    elif isinstance(parameter.default, float) and type(change.value) is int:
        remedy = f"write {float(change.value)!r}"
    elif isinstance(parameter.default, str):
        remedy = f"quote it, as {str(change.value)!r} within further quotes"
    else:
        remedy = f"set it to a value such as {parameter.default!r}"
    return parameter.refusal(node.get_name(), change.value, remedy)


def _no_effect(node: Changed, change: Parameter) -> str:
    """It would be accepted and change nothing."""
    known = node.has_parameter(change.name) and change.name in {p.name for p in node.PARAMETERS if not p.live}
    if not known or not node.settled or change.value == node.value(change.name):
        return ""
    return (
        f"{change.name} is read when /{node.get_name()} is configured; deactivate it and clean it "
        "up first (ros2 lifecycle set), or start it with the new value"
    )
