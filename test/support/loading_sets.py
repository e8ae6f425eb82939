"""Generators of measurement sets and raw files, made by the simulated truth, which shares no model code."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.simulation.truth.robot import TruthRobot

ROTATION = math.atan2(219.25, 226.66)
LOAD_POINT = np.array([0.0, 0.0, 0.18])
REFLECTORS = {
    "base": (1, [0.12, -0.1, 0.48]),
    "elbow": (2, [0.02, 0.05, 0.1]),
    "arm": (3, [0.05, 0.1, 0.1]),
    "wrist": (4, [0.0, 0.095, 0.05]),
    "ee": (6, [0.088, 0.25, 0.207]),
}


@pytest.fixture(scope="session")
def robot():
    return load_robot("irb6600_175_255")


@pytest.fixture(scope="session")
def kinematics(robot):
    return Kinematics(robot)


@dataclass
class Truth:
    """A generated set: where it is and what made it."""

    folder: Path
    stiffness: np.ndarray
    q: np.ndarray


def write_set(
    folder: Path, truth: TruthRobot, seed: int, n: int = 60, noise=(8e-6, 0.3, 0.03), directed: bool = False
) -> Truth:
    rng = np.random.default_rng(seed)
    folder.mkdir(parents=True, exist_ok=True)
    robot = load_robot("irb6600_175_255")
    low, high = np.maximum(robot.lower, -1.6), np.minimum(robot.upper, 1.6)
    q = rng.uniform(low * 0.6, high * 0.6, (n, 6))
    # Force of a weight in any direction; a couple of a weight on an arm.
    force = rng.normal(size=(n, 3))
    force *= 400.0 / np.linalg.norm(force, axis=1, keepdims=True)
    wrench = np.hstack([force, rng.normal(scale=60.0, size=(n, 3))])
    # Each joint comes from a side of its own, or nobody knows from which.
    direction = rng.choice([-1, 1], size=(n, 6)) if directed else np.zeros((n, 6), dtype=int)
    names = [list(REFLECTORS)[i % len(REFLECTORS)] for i in range(n)]
    rest, bent = truth.link_frames(q), truth.deflected_frames(q, wrench, LOAD_POINT, direction)
    c, s = math.cos(ROTATION), math.sin(ROTATION)
    R_flange_sensor = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    rows = []
    for i in range(n):
        link, position = REFLECTORS[names[i]]
        point = np.append(position, 1.0)
        d = (bent[i, link] @ point - rest[i, link] @ point)[:3] + rng.normal(scale=noise[0], size=3)
        R_sensor_base = (rest[i, 6, :3, :3] @ R_flange_sensor).T
        f = R_sensor_base @ wrench[i, :3] + rng.normal(scale=noise[1], size=3)
        m = R_sensor_base @ wrench[i, 3:] + rng.normal(scale=noise[2], size=3)
        numbers = [*q[i], *direction[i], *f, *m]
        rows.append([i, 10.0 * i, 5.0, "", *map(repr, map(float, numbers[:6])), *numbers[6:12],
                     *map(repr, map(float, numbers[12:])), names[i], *map(repr, map(float, d))])  # fmt: skip
    header = "trial t dt temperature q1 q2 q3 q4 q5 q6 a1 a2 a3 a4 a5 a6 fx fy fz mx my mz reflector dx dy dz"
    with open(folder / "trials.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header.split(), *rows])
    document = {
        "schema": "doormill/measurement-set/1",
        "robot": "irb6600_175_255",
        "model": {"joint_stiffness": [float(k) for k in robot.stiffness]},
        "noise": {"displacement": noise[0], "force": noise[1], "torque": noise[2]},
        "wrench_frame_rotation": ROTATION,
        "load_point": LOAD_POINT.tolist(),
        "reflectors": {name: {"link": link, "position": p} for name, (link, p) in REFLECTORS.items()},
    }
    (folder / "set.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    return Truth(folder, truth.physics.stiffness, q)


@pytest.fixture
def make_set(tmp_path, robot) -> Callable[..., Truth]:
    def make(stiffness: np.ndarray, seed: int = 0, **options) -> Truth:
        effects = options.pop("effects", ())
        truth = TruthRobot(robot.dh, effects, stiffness=stiffness)
        return write_set(tmp_path / f"set{seed}", truth, seed, **options)

    return make
