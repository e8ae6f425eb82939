"""Draws what a simulated robot or lab hides: cause, place and size from a seed."""

from __future__ import annotations

from typing import Any

import numpy as np

from support.truth.loading_test import LoadingPlan, recorded_wrench, true_displacement

#: The causes with fixed names; each must be drawn.
LIBRARY_CAUSES = (
    "joint_stiffness",
    "joint_backlash",
    "joint_hardening",
    "joint_cross_compliance",
    "link_bending",
    "base_compliance",
    "tool_compliance",
    "wrench_frame_rotation",
    "wrench_gain",
    "tracker_frame_rotation",
    "tracker_scale",
    "thermal_drift",
    "reflector_position",
    "joint_offset",
)
#: Effects that no library of causes has a name for.
FOREIGN_CAUSES = ("joint_ripple", "joint_dead_zone", "link_torsion", "tracker_jump", "warm_springs")


def draw_effect(rng: np.random.Generator, plan: LoadingPlan, cause: str) -> dict[str, Any]:
    """An effect of this cause at a random place, of unit-like size (scale it with `scale_effect`)."""
    joint = f"joint {rng.integers(1, 7)}"
    k = int(joint[-1]) - 1
    link = f"link {rng.integers(1, 5)}"
    # Torsion of link 4 lies on the axis of joint 4: it would be that joint's spring.
    twisted = f"link {rng.integers(1, 4)}"
    name = str(rng.choice(list(plan.reflectors)))
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    sign = float(rng.choice([-1.0, 1.0]))
    ripple = {"amplitude": sign * 0.3 / plan.stiffness[k], "order": int(rng.integers(3, 9))}
    table: dict[str, tuple[str, dict[str, Any]]] = {
        "joint_stiffness": (joint, {"stiffness": plan.stiffness[k] / (1.0 + 0.3 * rng.choice([-1.0, 1.0]))}),
        "joint_backlash": (
            joint,
            {"gap": 1e-4, "crossing": float(rng.choice([0.0, rng.uniform(5.0, 60.0)]))},
        ),
        "joint_hardening": (joint, {"stiffness": plan.stiffness[k], "hardening": 1e-3}),
        "joint_cross_compliance": (joint, {"compliance": 1e-7}),
        "link_bending": (link, {"EI": 1e6}),
        "base_compliance": ("base", {"stiffness": 1e7}),
        "tool_compliance": ("flange", {"stiffness": 1e5}),
        "wrench_frame_rotation": ("sensor", {"angle": 0.05 * sign}),
        "wrench_gain": ("sensor", {"factor": 1.0 + 0.1 * sign}),
        "tracker_frame_rotation": ("tracker", {"rotation_vector": 0.05 * direction}),
        "tracker_scale": ("tracker", {"factor": 1.0 + 0.1 * sign}),
        "thermal_drift": ("cell", {"velocity": 2e-7 * direction}),
        "reflector_position": (name, {"offset": 0.05 * direction}),
        "joint_offset": (joint, {"angle": 0.02 * sign}),
        "joint_ripple": (joint, ripple),
        "joint_dead_zone": (joint, {"torque": 20.0}),
        "link_torsion": (twisted, {"GJ": 1e6}),
        "tracker_jump": ("tracker", {"step": 2e-5 * direction, "time": float(np.quantile(plan.time, 0.6))}),
        "warm_springs": ("cell", {"per_degree": 0.1 * sign}),
    }
    where, parameters = table[cause]
    return {"cause": cause, "where": where, "parameters": parameters}


#: How the size of an effect enters: multiplied, divided, or as distance from 1 or from the model.
_MULTIPLY = {
    "joint_backlash": "gap",
    "joint_hardening": "hardening",
    "joint_cross_compliance": "compliance",
    "wrench_frame_rotation": "angle",
    "tracker_frame_rotation": "rotation_vector",
    "thermal_drift": "velocity",
    "reflector_position": "offset",
    "joint_offset": "angle",
    "joint_ripple": "amplitude",
    "joint_dead_zone": "torque",
    "tracker_jump": "step",
    "warm_springs": "per_degree",
}
_DIVIDE = {
    "link_bending": "EI",
    "base_compliance": "stiffness",
    "tool_compliance": "stiffness",
    "link_torsion": "GJ",
}


#: No effect is drawn larger than this: beyond it a lab would see it with the naked eye.
_LARGEST = {
    "joint_hardening": 5e-3,
    "wrench_frame_rotation": 0.3,
    "tracker_frame_rotation": 0.3,
    "reflector_position": 0.15,
    "joint_offset": 0.15,
    "joint_dead_zone": 100.0,
}


def resize(effect: dict[str, Any], size: float, plan: LoadingPlan) -> dict[str, Any]:
    """The same effect `size` times as large."""
    cause, parameters = effect["cause"], dict(effect["parameters"])
    if cause in _MULTIPLY:
        value = parameters[_MULTIPLY[cause]] * size
        over = float(np.linalg.norm(value)) / _largest(effect, plan)
        parameters[_MULTIPLY[cause]] = value / max(over, 1.0)
    elif cause in _DIVIDE:
        parameters[_DIVIDE[cause]] = parameters[_DIVIDE[cause]] / size
    elif cause in ("wrench_gain", "tracker_scale"):
        parameters["factor"] = 1.0 + (parameters["factor"] - 1.0) * size
    elif cause == "joint_stiffness":
        model = plan.stiffness[int(effect["where"][-1]) - 1]
        extra = (1.0 / parameters["stiffness"] - 1.0 / model) * size
        parameters["stiffness"] = 1.0 / max(1.0 / model + extra, 0.15 / model)
    return {**effect, "parameters": parameters}


def _largest(effect: dict[str, Any], plan: LoadingPlan) -> float:
    largest = _LARGEST.get(effect["cause"], np.inf)
    if effect["where"].startswith("joint"):
        # Lever arms, and with them torques, are ten times shorter at the wrist.
        wrist = int(effect["where"][-1]) > 3
        if effect["cause"] == "joint_dead_zone" and wrist:
            largest = 15.0
        if effect["cause"] == "joint_hardening" and wrist:
            largest = 5e-2
    return largest


def effect_rms(plan: LoadingPlan, effects: list[dict[str, Any]]) -> float:
    """Root mean square, over all displacement components, by which effects change what is simulated [m].

    A sensor that reads wrongly changes the simulation and not the motion, so it is measured by
    the motion that its wrong reading would cause.
    """
    change = true_displacement(plan, effects) - true_displacement(plan, [])
    read, honest = recorded_wrench(plan, effects), recorded_wrench(plan, [])
    if not np.array_equal(read, honest):
        c, s = np.cos(plan.sensor_rotation), np.sin(plan.sensor_rotation)
        turn_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        believed = np.hstack([read[:, :3] @ turn_z.T, read[:, 3:] @ turn_z.T])
        fake = LoadingPlan(**{**vars(plan), "wrench": believed})
        change = change + true_displacement(plan, []) - true_displacement(fake, [])
    return float(np.sqrt(np.mean(change**2)))


def scale_effect(effect: dict[str, Any], plan: LoadingPlan, rms: float) -> dict[str, Any]:
    """Resize an effect so that it changes the displacements by `rms` [m], as far as it can."""
    size = 1.0
    for _ in range(12):
        now = effect_rms(plan, [resize(effect, size, plan)])
        if now <= 0.0:
            return resize(effect, size, plan)
        factor = float(np.clip(rms / now, 0.2, 5.0))
        size = float(np.clip(size * factor, 1e-3, 1e3))
        if abs(factor - 1.0) < 0.02:
            break
    return resize(effect, size, plan)
