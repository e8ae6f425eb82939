"""A parameter of a node: what it means and what it may be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor


@dataclass(frozen=True)
class NodeParameter:
    """A declared parameter: name, default, what it means with its unit, allowed range or `choices`.

    One that is not `live` is read when the node is configured, and changes of it are refused from then on.
    """

    name: str
    default: Any
    description: str
    low: float | None = None
    high: float | None = None
    live: bool = False
    choices: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        """What its values are, after "allowed is"."""
        if self.choices:
            return f"one of {', '.join(repr(choice) for choice in self.choices)}"
        kind = type(self.default).__name__
        if self.low is None or self.high is None:
            limits = ""
        else:  # whole numbers in all their digits
            limits = " from {:d} to {:d}" if kind == "int" else " from {:g} to {:g}"
            limits = limits.format(*map(type(self.default), (self.low, self.high)))
        return f"{'an' if kind == 'int' else 'a'} {kind}{limits}"

    def refusal(self, node: str, value: object, remedy: str) -> str:
        """Why a node cannot take a value, and what to do."""
        told = f": {self.description}" if self.description else ""
        return f"parameter {self.name} of /{node} is {value!r}, allowed is {self.allowed}{told}; {remedy}"

    def descriptor(self) -> ParameterDescriptor:
        """The ROS descriptor."""
        descriptor = ParameterDescriptor(description=self.description)
        if self.choices:
            descriptor.additional_constraints = self.allowed
        if self.low is None or self.high is None:
            return descriptor
        if isinstance(self.default, float):
            descriptor.floating_point_range = [FloatingPointRange(from_value=self.low, to_value=self.high)]
        else:
            descriptor.integer_range = [IntegerRange(from_value=int(self.low), to_value=int(self.high))]
        return descriptor
