"""The model that a diagnosis of doors leaves for the path generator: what the correction can undo."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.diagnosis.parts.problem import DoorDiagnosis
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.extended_model import SizedCause, model_document


def usable(diagnosis: DoorDiagnosis) -> tuple[list[SizedCause], list[str]]:
    """Causes that the correction can take, as they are at the last door, and what it cannot, in words."""
    found, others = [], []
    for finding in diagnosis.findings:
        cause = finding.cause
        variant = cause.effect.variant if cause.name != "joint_backlash" else ""
        try:
            known = build_cause(cause.name, cause.where, variant)
        except KeyError:
            others.append(f"{cause.name} at {cause.where}")
            continue
        size = sum(parameter.size for parameter in known.parameters)
        found.append(SizedCause(known, np.array(finding.values[:size])))
    return found, others


def door_model_document(diagnosis: DoorDiagnosis, source: str) -> dict[str, Any]:
    """The content of model.yaml."""
    robot = diagnosis.problem.robot
    return model_document(
        robot.name,
        np.array(robot.stiffness),
        usable(diagnosis)[0],
        f"diagnosis of {source}, verdict {diagnosis.verdict}",
    )
