"""What an identification comes to, as a document for a machine, as text for a person and as robot.yaml."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.files import is_same, write_together
from doormill_ros.identification.joint_by_joint import JointStep
from doormill_ros.identification.weighted import StiffnessFit
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import SCHEMA as ROBOT_SCHEMA
from doormill_ros.robot.description import Robot
from doormill_ros.units import m_to_um, rad_to_deg

SCHEMA = "doormill/identification/1"
JSON_NAME, ROBOT_NAME = "identification.json", "robot.yaml"
#: Mean squared residual, in variances, above which springs in the joints do not explain the data.
MISFIT = 2.0


@dataclass(frozen=True, eq=False)
class Outcome:
    """Identified stiffness and how it came about.

    Attributes:
        robot: The robot it belongs to.
        source: Where the data came from, for the robot file.
        stiffness: Shape (6,) [N m/rad], NaN where the data do not tell.
        std: Its standard deviation, shape (6,) [N m/rad].
        lines: Text to print.
        document: Everything else for the JSON file.
    """

    robot: Robot
    source: str
    stiffness: FloatArray
    std: FloatArray
    lines: list[str]
    document: dict[str, Any] = field(default_factory=dict)

    def write(self, out: Path) -> list[Path]:
        """Write identification.json, and robot.yaml with its URDF, which `load_robot` takes; together or not at all.

        Returns:
            The files.

        Raises:
            OSError: One cannot be written; an earlier identification stays.
        """
        document, robot, urdf = out / JSON_NAME, out / ROBOT_NAME, out / self.robot.urdf.name
        contents: dict[Path, bytes | str] = {}
        if not is_same(urdf, self.robot.urdf):
            contents[urdf] = self.robot.urdf.read_bytes()
        contents[robot] = _robot_yaml(self)
        contents[document] = json.dumps(self._json(), indent=2, allow_nan=False) + "\n"
        out.mkdir(parents=True, exist_ok=True)
        write_together(contents)
        return [document, robot, urdf]

    def _json(self) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "robot": self.robot.name,
            "source": self.source,
            "unit": "N m / rad",
            "stiffness": plain(self.stiffness),
            "std": plain(self.std),
            **plain(self.document),
        }


def outcome_of_loadings(
    robot: Robot,
    source: str,
    steps: list[JointStep],
    fit: StiffnessFit,
    loadings: int,
    outliers: Sequence[int] | IntArray = (),
) -> Outcome:
    """Outcome of loadings that were identified both ways; `outliers` names trials that were left out, shape (k,)."""
    by_joint = {step.joint: step for step in steps}
    reduced = fit.chi_square / fit.degrees_of_freedom if fit.degrees_of_freedom > 0 else float("nan")
    lines = [
        f"{loadings} loadings of {robot.label}",
        "joint   one by one       isolation   all at once [N m/rad]",
    ]
    for joint in range(1, JOINTS + 1):
        step = by_joint[joint]
        one = (
            f"{step.stiffness:11.4g} +- {step.std:<9.2g}"
            if math.isfinite(step.stiffness)
            else f"{'-':>11}" + " " * 13
        )
        k, s = fit.stiffness[joint - 1], fit.std[joint - 1]
        all_ = f"{k:11.4g} +- {s:<9.2g} ({s / k:.1%})" if math.isfinite(k) else f"{'not told':>11}"
        lines.append(f"{joint:>5} {one} {step.isolation:6.2f} {all_}")
    lines.append(f"residual {m_to_um(fit.rmse):.1f} um rms, chi-square per degree of freedom {reduced:.2f}")
    if len(outliers):
        lines.append(f"left out as gross errors, worst first: trials {', '.join(map(str, outliers))}")
    if reduced > MISFIT:
        lines.append("springs in the joints do not explain these data: run `diagnose`")
    document = {
        "one_by_one": [vars(step) for step in steps],
        "all_at_once": {
            "stiffness": fit.stiffness,
            "std": fit.std,
            "compliance": fit.compliance,
            "compliance_covariance": fit.compliance_covariance,
            "rmse": fit.rmse,
            "chi_square": fit.chi_square,
            "degrees_of_freedom": fit.degrees_of_freedom,
        },
        "loadings": loadings,
        "outliers": list(outliers),
    }
    return Outcome(robot, source, fit.stiffness, fit.std, lines, document)


def add_preload(outcome: Outcome, fit: StiffnessFit) -> None:
    """Add the stiffness of pre-loaded and not pre-loaded joints (table 4.3) to text and document.

    Args:
        outcome: What to add to.
        fit: Twelve stiffnesses, pre-loaded joints first.
    """
    outcome.lines.append(
        "joint   pre-loaded [N m/rad]              not pre-loaded              not / pre-loaded"
    )
    for joint in range(JOINTS):
        (k, s), (k0, s0) = ((fit.stiffness[i], fit.std[i]) for i in (joint, joint + JOINTS))
        one, other = (
            f"{a:11.4g} +- {b:<9.2g}" if math.isfinite(a) else f"{'not told':>24}"
            for a, b in ((k, s), (k0, s0))
        )
        ratio = f"{k0 / k:6.3f} +- {k0 / k * math.hypot(s / k, s0 / k0):.3f}" if math.isfinite(k0 / k) else ""
        outcome.lines.append(f"{joint + 1:>5} {one} {other} {ratio}")
        # Play makes a joint softer when it is not pre-loaded, by more than both deviations.
        if k - k0 > 4.0 * math.hypot(s, s0):
            outcome.lines.append(
                f"joint {joint + 1} has play, and one spring does not describe it: run `diagnose`"
            )
    outcome.document["by_preload"] = {
        "preloaded": {"stiffness": fit.stiffness[:JOINTS], "std": fit.std[:JOINTS]},
        "not_preloaded": {"stiffness": fit.stiffness[JOINTS:], "std": fit.std[JOINTS:]},
    }


def plain(value: Any) -> Any:
    """Arrays as lists, numbers as Python numbers, and what is not finite as None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, int | np.integer):
        return int(value)
    return float(value) if math.isfinite(value) else None


def _degrees(angles: FloatArray) -> list[float]:
    return [round(float(angle), 9) for angle in rad_to_deg(angles)]


def _robot_yaml(outcome: Outcome) -> str:
    """The robot's own YAML with the stiffness replaced; joints that were not told keep what they had."""
    robot = outcome.robot
    document: dict[str, Any] = {
        "schema": ROBOT_SCHEMA,
        "label": robot.label,
        "urdf": robot.urdf.name,
        "reach": {"value": robot.reach},
        "payload": {"value": robot.payload},
        "limits": {
            "lower": _degrees(robot.lower),
            "upper": _degrees(robot.upper),
        },
        "max_velocity": {"value": _degrees(robot.max_velocity)},
    }
    for name, origin in robot.provenance.items():
        if name in document:
            document[name] |= {"source": origin.source, "measured": origin.measured}
    told = np.isfinite(outcome.stiffness)
    source = outcome.source
    if not told.all():
        kept = ", ".join(str(j + 1) for j in np.flatnonzero(~told))
        source += f"; joints {kept} were not told and keep: {robot.provenance['stiffness'].source}"
    document["stiffness"] = {
        "value": [float(f"{k:.6g}") for k in np.where(told, outcome.stiffness, robot.stiffness)],
        "std": [float(f"{s:.3g}") if ok else None for s, ok in zip(outcome.std, told, strict=True)],
        "source": source,
        "measured": True,
    }
    head = "# Written by `identify`. Angles in degrees, everything else SI.\n"
    return head + yaml.safe_dump(document, sort_keys=False, allow_unicode=True)
