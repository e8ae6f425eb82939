"""How doors are milled: the values of config/toolpath.yaml."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import transform
from doormill_ros.resources import resource
from doormill_ros.toolpath.errors import PathSettingsError


@dataclass(frozen=True)
class Approach:
    """Motions in the air.

    Attributes:
        clearance: Tool tip in front of the surface between features [m].
        edge_clearance: The same while the spindle swings from one side of the door to another [m].
        retreats: How far to draw back, one after the other, where the straight way close to the
            door is not possible [m].
        rapid_speed: Speed in the air [m/s].
        plunge_speed: Speed of the way down to the wood [m/s].
        nose: How far the mill reaches out of the spindle or its holder [m].
        mill_radius: Of the widest mill [m].
        spindle_radius: Of spindle and holder [m].
    """

    clearance: float
    edge_clearance: float
    retreats: tuple[float, ...]
    rapid_speed: float
    plunge_speed: float
    nose: float
    mill_radius: float
    spindle_radius: float


@dataclass(frozen=True)
class Correction:
    """Limits of the process force correction.

    Attributes:
        limit: Largest translation between nominal and corrected pose [m].
        tolerance: Accepted distance of the loaded tool from the nominal pose [m].
        bend: A segment is divided where its correction bends by more [m].
        blend: Length over which the wrench of one segment becomes that of the next [m].
        step: Largest step of the correction where the wrench changes [m].
        shortest: No segment is divided below this length [m].
    """

    limit: float
    tolerance: float
    bend: float
    blend: float
    step: float
    shortest: float


@dataclass(frozen=True)
class Checks:
    """Limits of the whole-door checks.

    Attributes:
        targets: Most targets of a program.
        tools: Most tools that a program of one robot may need.
        joint_margin: Distance kept from each joint limit [rad].
        wrist: Smallest angle of axis 5 from straight [rad].
        elbow: Smallest angle of the forearm from in line with the lower arm [rad].
        shoulder: Smallest distance of the wrist centre from axis 1 [m].
        joint_speed_share: Allowed share of the joints' speed limits.
    """

    targets: float
    tools: float
    joint_margin: float
    wrist: float
    elbow: float
    shoulder: float
    joint_speed_share: float


@dataclass(frozen=True)
class Cycle:
    """Accelerations, and the times that appendix A.1 of the thesis allows.

    Attributes:
        acceleration: Of the tool centre point [m/s^2].
        joint_acceleration: Of the slowest joint of a MoveJ [rad/s^2].
        hinges: All hinges of a door [s].
        hole_side: One handle hole from one side [s].
        lock_case: The lock case and its face plate [s].
        probing: Finding the door [s].
        total: One door from clamp to clamp [s].
    """

    acceleration: float
    joint_acceleration: float
    hinges: float
    hole_side: float
    lock_case: float
    probing: float
    total: float


@dataclass(frozen=True)
class SecondRobot:
    """Where the second milling robot stands.

    Attributes:
        position: Its base in the first robot's base frame, shape (3,) [m].
        rotation: About z [rad].
    """

    position: tuple[float, float, float]
    rotation: float

    @property
    def T_base_second(self) -> FloatArray:
        """Its base frame in the first robot's, shape (4, 4)."""
        return transform(Rotation.from_euler("z", self.rotation).as_matrix(), np.array(self.position))


@dataclass(frozen=True)
class PathSettings:
    """Everything in config/toolpath.yaml."""

    approach: Approach
    correction: Correction
    checks: Checks
    cycle: Cycle
    second_robot: SecondRobot


def load_settings(path: Path | None = None) -> PathSettings:
    """Read config/toolpath.yaml, or another file of the same form.

    Raises:
        PathSettingsError: A value is missing, unknown or impossible.
    """
    path = path or resource("config/toolpath.yaml")
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    parts = {
        "approach": Approach,
        "correction": Correction,
        "checks": Checks,
        "cycle": Cycle,
        "second_robot": SecondRobot,
    }
    if not isinstance(document, dict) or set(document) != set(parts):
        found = sorted(document) if isinstance(document, dict) else type(document).__name__
        raise PathSettingsError(
            f"{path} holds {found}, allowed are exactly {sorted(parts)}; correct the file"
        )
    return PathSettings(**{name: _part(path, name, kind, document[name]) for name, kind in parts.items()})


def _part(path: Path, name: str, kind: type, values: Any) -> Any:
    known = [item.name for item in fields(kind)]
    if not isinstance(values, dict) or set(values) != set(known):
        found = sorted(values) if isinstance(values, dict) else type(values).__name__
        raise PathSettingsError(f"{name} in {path} holds {found}, allowed are exactly {sorted(known)}")
    if kind is SecondRobot:
        return _second_robot(path, values)
    numbers = {key: value for key, value in values.items() if key != "retreats"}
    numbers |= {f"retreats[{i}]": value for i, value in enumerate(values.get("retreats", ()))}
    for key, value in numbers.items():
        good = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        if not good or value <= 0.0:
            raise PathSettingsError(f"{name}.{key} in {path} is {value!r}, allowed is a positive number")
    plain = {key: float(value) for key, value in values.items() if key != "retreats"}
    if kind is Approach:
        plain["retreats"] = tuple(float(value) for value in values["retreats"])
    return kind(**plain)


def _second_robot(path: Path, values: dict[str, Any]) -> SecondRobot:
    try:
        position = np.array(values["position"], dtype=float)
        rotation = float(values["rotation"])
    except (TypeError, ValueError):
        position, rotation = np.zeros(0), math.nan
    if position.shape != (3,) or not np.all(np.isfinite([*position, rotation])):
        raise PathSettingsError(
            f"second_robot in {path} is {values!r}, allowed are three numbers for position, one for rotation"
        )
    return SecondRobot(tuple(position.tolist()), rotation)
