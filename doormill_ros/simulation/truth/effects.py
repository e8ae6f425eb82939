"""Reads the plain description of what a simulated robot hides: cause, place and size."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray


@dataclass
class Physics:
    """Every size the truth needs; the default is a robot of six linear springs.

    Attributes:
        stiffness: Joint springs at zero torque, shape (6,) [N m / rad].
        hardening: h in K = K0 (1 + h abs(torque)), shape (6,) [1 / (N m)].
        gap, crossing: Backlash [rad] and the torque that crosses it [N m], shape (6,).
        friction: Torque a pre-loaded joint carries before its spring moves, shape (6,) [N m].
        dead_zone: Torque every joint carries before its spring moves, shape (6,) [N m].
        cross: Compliance about the two axes across the joint axis, shape (6,) [rad / (N m)].
        bending: 1 / EI of each link, shape (6,) [1 / (N m^2)].
        torsion: 1 / GJ of each link, shape (6,) [1 / (N m^2)].
        base, tool: Compliance about x and y of base and flange, shape (2,) [rad / (N m)].
        offset: Joint offsets, shape (6,) [rad].
        ripple: Amplitude [rad / (N m)] and order of a compliance that varies with the joint angle, (6, 2).
    """

    stiffness: FloatArray
    hardening: FloatArray = field(default_factory=lambda: np.zeros(6))
    gap: FloatArray = field(default_factory=lambda: np.zeros(6))
    crossing: FloatArray = field(default_factory=lambda: np.zeros(6))
    friction: FloatArray = field(default_factory=lambda: np.zeros(6))
    dead_zone: FloatArray = field(default_factory=lambda: np.zeros(6))
    cross: FloatArray = field(default_factory=lambda: np.zeros(6))
    bending: FloatArray = field(default_factory=lambda: np.zeros(6))
    torsion: FloatArray = field(default_factory=lambda: np.zeros(6))
    base: FloatArray = field(default_factory=lambda: np.zeros(2))
    tool: FloatArray = field(default_factory=lambda: np.zeros(2))
    offset: FloatArray = field(default_factory=lambda: np.zeros(6))
    ripple: FloatArray = field(default_factory=lambda: np.zeros((6, 2)))


#: Effects that sit in the measuring chain and leave the robot itself alone.
MEASURING = {
    "wrench_frame_rotation",
    "wrench_gain",
    "tracker_frame_rotation",
    "tracker_scale",
    "thermal_drift",
    "reflector_position",
    "tracker_jump",
    "warm_springs",
}


def _place(where: str, kind: str) -> int:
    """Zero-based number in 'joint 3' or 'link 3'."""
    word, _, number = where.partition(" ")
    if word != kind or not number.isdigit() or not 1 <= int(number) <= 6:
        raise ValueError(f"effect sits at {where!r}, allowed is '{kind} 1' to '{kind} 6'")
    return int(number) - 1


def read_effects(effects: Iterable[Mapping[str, Any]], stiffness: FloatArray) -> Physics:
    """Turn effects `{cause, where, parameters}` into the sizes of the physics.

    Args:
        effects: Parameters by name, plain numbers in SI units; effects of the measuring chain are skipped.
        stiffness: Joint springs without any effect, shape (6,) [N m / rad].

    Raises:
        ValueError: Unknown cause, impossible place, missing parameter.
    """
    physics = Physics(np.array(stiffness, dtype=float))
    for effect in effects:
        cause, where = effect["cause"], str(effect["where"])
        values = dict(effect["parameters"])
        try:
            _apply(physics, cause, where, values)
        except KeyError as error:
            raise ValueError(
                f"effect {cause} at {where} lacks parameter {error}, found {sorted(values)}"
            ) from None
    return physics


def _apply(physics: Physics, cause: str, where: str, values: dict[str, Any]) -> None:
    if cause in MEASURING:
        return
    if cause in ("joint_stiffness", "joint_hardening"):
        k = _place(where, "joint")
        physics.stiffness[k] = values["stiffness"]
        physics.hardening[k] = values["hardening"] if cause == "joint_hardening" else 0.0
    elif cause == "joint_backlash":
        k = _place(where, "joint")
        physics.gap[k], physics.crossing[k] = values["gap"], values.get("crossing", 0.0)
    elif cause == "joint_friction":
        physics.friction[_place(where, "joint")] = values["torque"]
    elif cause == "joint_dead_zone":
        physics.dead_zone[_place(where, "joint")] = values["torque"]
    elif cause == "joint_cross_compliance":
        physics.cross[_place(where, "joint")] = values["compliance"]
    elif cause == "link_bending":
        physics.bending[_place(where, "link")] = 1.0 / values["EI"]
    elif cause == "link_torsion":
        physics.torsion[_place(where, "link")] = 1.0 / values["GJ"]
    elif cause == "base_compliance":
        physics.base = 1.0 / np.broadcast_to(np.asarray(values["stiffness"], dtype=float), (2,))
    elif cause == "tool_compliance":
        physics.tool = 1.0 / np.broadcast_to(np.asarray(values["stiffness"], dtype=float), (2,))
    elif cause == "joint_offset":
        physics.offset[_place(where, "joint")] = values["angle"]
    elif cause == "joint_ripple":
        physics.ripple[_place(where, "joint")] = values["amplitude"], values["order"]
    else:
        raise ValueError(f"effect {cause!r} is not known to the simulated truth")
