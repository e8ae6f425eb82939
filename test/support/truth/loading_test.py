"""A simulated lab: loads the truth robot, measures reflectors with noise and writes a measurement set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doormill_ros.simulation.truth.chain import chain, turn
from doormill_ros.simulation.truth.robot import DEFAULT_STIFFNESS, TruthRobot

HEADER = "trial,t,dt,temperature,q1,q2,q3,q4,q5,q6,a1,a2,a3,a4,a5,a6,fx,fy,fz,mx,my,mz,reflector,dx,dy,dz"


@dataclass(frozen=True, eq=False)
class LoadingPlan:
    """What a lab decides to do; one trial a row.

    Attributes:
        q: Commanded joint angles, shape (n, 6) [rad].
        direction: Last motion of each joint, -1 or +1, shape (n, 6).
        wrench: Wrench at the load point in flange axes, shape (n, 6) [N, N m].
        reflector: Name measured in each trial, length n.
        time, dt: Shape (n,) [s].
        temperature: Shape (n,) [deg C], NaN where not recorded.
        reflectors: Link and position (3,) [m] by name.
        load_point: Flange frame, shape (3,) [m].
        sensor_rotation: Sensor to flange axes about flange z, as stated [rad].
        noise: Standard deviation of displacement [m], force [N], torque [N m].
        stiffness: Joint springs of the model in question, shape (6,) [N m / rad].
        robot: Name of the robot.
        dh: Its table, shape (6, 4).
    """

    q: np.ndarray
    direction: np.ndarray
    wrench: np.ndarray
    reflector: tuple[str, ...]
    time: np.ndarray
    dt: np.ndarray
    temperature: np.ndarray
    reflectors: dict[str, tuple[int, np.ndarray]]
    dh: np.ndarray
    load_point: np.ndarray
    sensor_rotation: float = 0.7688
    noise: tuple[float, float, float] = (8e-6, 0.3, 0.03)
    stiffness: np.ndarray = field(default_factory=lambda: DEFAULT_STIFFNESS.copy())
    robot: str = "irb6600_175_255"

    def __len__(self) -> int:
        return len(self.q)


#: Size and position of the boxes from which postures are drawn [rad].
_MIDDLE = np.array([0.0, 0.15, -0.3, 0.0, 0.3, 0.0])
_HALF = np.array([1.3, 0.75, 0.7, 1.6, 1.3, 1.6])


#: Reflectors that labs use: a few on the flange, some further down the arm.
_REFLECTORS = {
    "ee": (6, np.array([0.05, 0.0, 0.18])),
    "tip": (6, np.array([-0.12, 0.09, 0.30])),
    "elbow": (3, np.array([0.10, -0.05, 0.12])),
    "shoulder": (1, np.array([-0.20, 0.10, 0.15])),
    "upper_arm": (2, np.array([-0.30, 0.05, 0.20])),
}

#: How a lab may go about it: which reflectors, whether it pulls with a rope along the axes of the
#: base frame, whether it waits the same time in every trial.
STYLES = (
    (("ee", "tip", "elbow"), False, False),
    (("ee",), False, False),
    (("ee", "tip"), True, False),
    (("ee", "elbow", "shoulder", "upper_arm"), True, True),
)


def draw_plan(
    rng: np.random.Generator, dh: np.ndarray, trials: int = 120, postures: int = 15, style: int = 0
) -> LoadingPlan:
    """A varied test: random postures and loads, last motions from both sides, in one of the STYLES."""
    names, rope, steady = STYLES[style]
    poses = _MIDDLE + _HALF * rng.uniform(-1.0, 1.0, (postures, 6))
    order = np.sort(np.arange(trials) % postures)
    size = rng.uniform(150.0, 700.0, (trials, 1))
    if rope:
        pull = np.vstack([np.eye(3), -np.eye(3)])[rng.integers(6, size=trials)]
        R_base_flange = chain(np.asarray(dh, dtype=float), poses[order])[:, 6, :3, :3]
        force = np.einsum("nji,nj->ni", R_base_flange, pull) * size
        couple = np.zeros((trials, 3))
    else:
        force = rng.normal(size=(trials, 3))
        force *= size / np.linalg.norm(force, axis=1, keepdims=True)
        couple = rng.normal(size=(trials, 3)) * 30.0
    dt = np.full(trials, 60.0) if steady else rng.uniform(15.0, 120.0, trials)
    time = np.cumsum(dt + rng.uniform(20.0, 60.0, trials))
    warm = 20.0 + 1.5 * time / time[-1] + 0.1 * rng.normal(size=trials)
    return LoadingPlan(
        q=poses[order],
        direction=rng.choice([-1.0, 1.0], size=(trials, 6)),
        wrench=np.column_stack([force, couple]),
        reflector=tuple(rng.choice(names, size=trials).tolist()),
        time=time,
        dt=dt,
        temperature=np.full(trials, np.nan) if steady else warm,
        reflectors={name: _REFLECTORS[name] for name in names},
        dh=np.array(dh, dtype=float),
        load_point=np.array([0.0, 0.0, 0.18]),
    )


def true_displacement(plan: LoadingPlan, effects: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """Displacement the tracker would report without any noise, shape (n, 3) [m], base frame."""
    robot = TruthRobot(plan.dh, effects, plan.stiffness)
    still = robot.link_frames(plan.q)
    # The load acts in flange axes: write it in base axes with the true orientation of the flange.
    to_base = still[:, 6, :3, :3]
    wrench = np.concatenate(
        [np.einsum("nij,nj->ni", to_base, plan.wrench[:, i : i + 3]) for i in (0, 3)], axis=1
    )
    loaded = robot.deflected_frames(plan.q, wrench, plan.load_point, plan.direction)
    moved = np.zeros((len(plan), 3))
    places = {name: (link, position.copy()) for name, (link, position) in plan.reflectors.items()}
    for effect in effects:
        if effect["cause"] == "reflector_position":
            link, position = places[effect["where"]]
            places[effect["where"]] = (link, position + np.asarray(effect["parameters"]["offset"]))
    for i, name in enumerate(plan.reflector):
        link, position = places[name]
        point = np.append(position, 1.0)
        moved[i] = ((loaded[i, link] - still[i, link]) @ point)[:3]
    # What the tracker adds by itself comes on top of what it turns and scales.
    for effect in sorted(effects, key=lambda effect: effect["cause"] in ("thermal_drift", "tracker_jump")):
        values = effect["parameters"]
        if effect["cause"] == "tracker_frame_rotation":
            moved = moved @ turn(np.asarray(values["rotation_vector"], dtype=float)[None])[0].T
        elif effect["cause"] == "tracker_scale":
            moved = moved * values["factor"]
        elif effect["cause"] == "thermal_drift":
            moved = moved + plan.dt[:, None] * np.asarray(values["velocity"])
        elif effect["cause"] == "tracker_jump":
            moved = moved + (plan.time > values["time"])[:, None] * np.asarray(values["step"])
        elif effect["cause"] == "warm_springs":
            # The cell warms by 1.5 degrees during the test, whether or not that is recorded.
            warm = 1.5 * plan.time / plan.time[-1]
            moved = moved * (1.0 + values["per_degree"] * warm)[:, None]
    return moved


def recorded_wrench(plan: LoadingPlan, effects: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """What the sensor reads without noise, sensor axes, shape (n, 6)."""
    angle, gain = plan.sensor_rotation, 1.0
    for effect in effects:
        if effect["cause"] == "wrench_frame_rotation":
            angle += effect["parameters"]["angle"]
        elif effect["cause"] == "wrench_gain":
            gain *= effect["parameters"]["factor"]
    to_sensor = turn(np.array([[0.0, 0.0, -angle]]))[0]
    return np.hstack([plan.wrench[:, :3] @ to_sensor.T, plan.wrench[:, 3:] @ to_sensor.T]) / gain


@dataclass(frozen=True)
class Spoil:
    """How the lab's record is spoilt besides the noise: share of gross errors and of unknown directions."""

    outliers: float = 0.0
    unknown_directions: float = 0.0


def write_loading_test(
    folder: Path,
    plan: LoadingPlan,
    effects: Sequence[Mapping[str, Any]],
    rng: np.random.Generator,
    spoil: Spoil | None = None,
) -> list[int]:
    """Carry out the plan and write set.yaml and trials.csv.

    Returns:
        Numbers of the trials with a gross error.
    """
    spoil = spoil or Spoil()
    n = len(plan)
    displacement = true_displacement(plan, effects) + rng.normal(0.0, plan.noise[0], (n, 3))
    noise = np.repeat(plan.noise[1:], 3)
    wrench = recorded_wrench(plan, effects) + rng.normal(size=(n, 6)) * noise
    bad = rng.choice(n, size=round(spoil.outliers * n), replace=False)
    size = rng.uniform(15.0, 120.0, (len(bad), 1)) * plan.noise[0]
    away = rng.normal(size=(len(bad), 3))
    displacement[bad] += size * away / np.linalg.norm(away, axis=1, keepdims=True)
    direction = np.where(rng.random((n, 1)) < spoil.unknown_directions, 0.0, plan.direction)
    folder.mkdir(parents=True, exist_ok=True)
    document = {
        "schema": "doormill/measurement-set/1",
        "robot": plan.robot,
        "model": {"joint_stiffness": [float(k) for k in plan.stiffness]},
        "noise": dict(zip(("displacement", "force", "torque"), map(float, plan.noise), strict=True)),
        "wrench_frame_rotation": float(plan.sensor_rotation),
        "load_point": plan.load_point.tolist(),
        "reflectors": {
            name: {"link": int(link), "position": position.tolist()}
            for name, (link, position) in plan.reflectors.items()
        },
    }
    (folder / "set.yaml").write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
    lines = [HEADER]
    for i in range(n):
        warm = "" if np.isnan(plan.temperature[i]) else f"{plan.temperature[i]:.2f}"
        numbers = [f"{v:.9g}" for v in plan.q[i]] + [f"{v:.0f}" for v in direction[i]]
        numbers += [f"{v:.6f}" for v in wrench[i]]
        lines.append(
            ",".join(
                [str(i + 1), f"{plan.time[i]:.3f}", f"{plan.dt[i]:.3f}", warm, *numbers, plan.reflector[i]]
                + [f"{v:.9e}" for v in displacement[i]]
            )
        )
    (folder / "trials.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return sorted(int(i) + 1 for i in bad)
