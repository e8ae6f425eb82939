"""A model that a diagnosis leaves, as model.yaml has it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.displacement import Displacement
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce
from doormill_ros.robot_model.elastic.law.term import LawTerm
from doormill_ros.robot_model.extended_model import SCHEMA, SizedCause
from doormill_ros.robot_model.warmth.growth import ThermalGrowth


def model_document(
    robot: str,
    joint_stiffness: FloatArray,
    causes: Sequence[SizedCause],
    source: str,
    unchanged: str = "",
    laws: Sequence[SizedCause] = (),
    force: MeasuredForce | None = None,
    standing: Displacement | None = None,
    growth: ThermalGrowth | None = None,
) -> dict[str, Any]:
    """The content of model.yaml.

    Args:
        robot: Name of the robot.
        joint_stiffness: Of the model that was questioned, shape (6,) [N m / rad].
        causes: What was established.
        source: Where the model comes from.
        unchanged: Why no cause is in it although some are in question; empty when that is not so.
        laws: What no cause names.
        force: How well doors told the process force.
        standing: Where they told the unloaded tool to stand.
        growth: How it comes forward as the cell warms up.
    """
    return {
        "schema": SCHEMA,
        "robot": robot,
        "source": source,
        **({"unchanged": unchanged} if unchanged else {}),
        "joint_stiffness": [float(k) for k in joint_stiffness],
        "causes": [_entry(sized) for sized in causes],
        **({"measured_force": force.document()} if force is not None else {}),
        **({"standing": standing.document()} if standing is not None else {}),
        **({"thermal_growth": growth.document()} if growth is not None else {}),
        **({"laws": [_law_entry(sized) for sized in laws]} if laws else {}),
    }


def _entry(sized: SizedCause) -> dict[str, Any]:
    return {
        "cause": sized.cause.name,
        "where": sized.cause.where,
        **({"variant": sized.cause.variant} if sized.cause.variant else {}),
        "parameters": _named(sized, sized.values),
        **({"std": _named(sized, sized.std)} if sized.std is not None else {}),
    }


def _law_entry(sized: SizedCause) -> dict[str, Any]:
    """A term of a law, or a cause that is not believed and is a part of one all the same."""
    if not isinstance(sized.cause, LawTerm):
        return _entry(sized)
    return sized.cause.document(sized.values)


def _named(sized: SizedCause, values: FloatArray) -> dict[str, float | list[float]]:
    named: dict[str, float | list[float]] = {}
    at = 0
    for parameter in sized.cause.parameters:
        part = values[at : at + parameter.size]
        named[parameter.name] = float(part[0]) if parameter.size == 1 else [float(v) for v in part]
        at += parameter.size
    return named
