"""Pose sets of an invented robot with hidden faults; kinematics and statics of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

# Lengths like those of a UR10, not its own.
DH = [
    [0.0, 0.1300, 0.0, np.pi / 2],
    [0.0, 0.0, -0.620, 0.0],
    [0.0, 0.0, -0.565, 0.0],
    [0.0, 0.1600, 0.0, np.pi / 2],
    [0.0, 0.1200, 0.0, -np.pi / 2],
    [0.0, 0.0950, 0.0, 0.0],
]
LINKS = [
    (7.0, (0.02, 0.0, 0.03)),
    (13.0, (0.37, 0.0, 0.16)),
    (4.0, (0.25, 0.0, 0.07)),
    (2.0, (0.0, 0.007, 0.018)),
    (2.0, (0.0, 0.007, 0.018)),
    (0.4, (0.0, 0.0, -0.026)),
]
NOISE = (1.5e-5, 6.0e-5)


@dataclass
class Faults:
    """What is wrong with the invented robot; lists of (joint or link, ...)."""

    geometry: Sequence[tuple[int, str, float]] = ()  # link, theta/d/a/alpha/beta, size
    sag: Sequence[tuple[int, float]] = ()  # joint, rad / (N m)
    periodic: Sequence[tuple[int, int, float, float]] = ()  # joint, order, amplitude, phase
    backlash: Sequence[tuple[int, float]] = ()  # joint, gap
    step: tuple[str, int, Sequence[float]] | None = None  # set, row, tracker displacement
    warming: tuple[str, Sequence[float], float] | None = (
        None  # set, tracker displacement in the end, constant [s]
    )
    gross: Sequence[tuple[str, int]] = ()  # set, row
    strange: float = 0.0  # size of an effect that no library holds
    stated: bool = True  # whether the sets state their noise
    names: Sequence[str] = field(default_factory=lambda: ("first", "second"))


def pose_of(q: np.ndarray, dh: np.ndarray, twist: Sequence[tuple[int, float]] = ()) -> np.ndarray:
    """T_base_flange of one posture: rotations and shifts one after the other."""
    beta = dict(twist)
    R, p = np.eye(3), np.zeros(3)
    for k in range(6):
        theta, d, a, alpha = q[k] + dh[k, 0], *dh[k, 1:]
        R = R @ Rotation.from_euler("z", theta).as_matrix()
        p = p + R @ np.array([a, 0.0, d])
        R = R @ Rotation.from_euler("x", alpha).as_matrix()
        R = R @ Rotation.from_euler("y", beta.get(k + 1, 0.0)).as_matrix()
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def potential(q: np.ndarray, down: Sequence[float] = (0.0, 0.0, -1.0)) -> float:
    """Potential energy [J] with the nominal lengths, gravity along a unit vector in base axes."""
    dh = np.array(DH)
    R, p, energy = np.eye(3), np.zeros(3), 0.0
    for k, (mass, com) in enumerate(LINKS):
        R = R @ Rotation.from_euler("z", q[k] + dh[k, 0]).as_matrix()
        p = p + R @ np.array([dh[k, 2], 0.0, dh[k, 1]])
        R = R @ Rotation.from_euler("x", dh[k, 3]).as_matrix()
        energy -= mass * 9.80665 * ((p + R @ np.array(com)) @ down)
    return energy


def gravity_torque(q: np.ndarray, joint: int, down: Sequence[float] = (0.0, 0.0, -1.0)) -> float:
    """Generalised force of gravity on a joint, by difference of the energy [N m]."""
    h = 1e-5
    above, below = q.copy(), q.copy()
    above[joint - 1] += h
    below[joint - 1] -= h
    return -(potential(above, down) - potential(below, down)) / (2.0 * h)


def write_sets(folder: Path, faults: Faults, rows: int, seed: int) -> list[Path]:
    """Write one set for every name of the faults."""
    rng = np.random.default_rng(seed)
    dh = np.array(DH)
    wrong = dh.copy()
    column = {"theta": 0, "d": 1, "a": 2, "alpha": 3}
    for link, name, size in faults.geometry:
        if name in column:
            wrong[link - 1, column[name]] += size
    beta = [(link, size) for link, name, size in faults.geometry if name == "beta"]
    folders = []
    for name in faults.names:
        q = rng.uniform([-2.5, -2.6, -2.2, -2.8, -2.3, -2.9], [2.5, -0.4, 2.2, 2.8, 2.3, 2.9], (rows, 6))
        base, target = np.eye(4), np.eye(4)
        base[:3, :3], base[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.uniform(-3.0, 3.0, 3)
        target[:3, :3], target[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.uniform(-0.15, 0.15, 3)
        lines = ["row,t,temperature,q1,q2,q3,q4,q5,q6,x,y,z,qw,qx,qy,qz,placement"]
        for i in range(rows):
            true = q[i].copy()
            for joint, order, size, phase in faults.periodic:
                true[joint - 1] += size * np.cos(order * q[i, joint - 1] - phase)
            for joint, compliance in faults.sag:
                true[joint - 1] += compliance * gravity_torque(q[i], joint)
            for joint, gap in faults.backlash:
                if i:
                    true[joint - 1] += 0.5 * gap * np.sign(q[i, joint - 1] - q[i - 1, joint - 1])
            T = base @ pose_of(true, wrong, beta) @ target
            p, R = T[:3, 3], T[:3, :3]
            if faults.strange:
                p = p + faults.strange * np.array(
                    [np.sin(9.0 * q[i, 0] * q[i, 1]), np.cos(7.0 * q[i, 2] * q[i, 4]), 0.0]
                )
            if faults.step and faults.step[0] == name and i >= faults.step[1]:
                p = p + np.array(faults.step[2])
            if faults.warming and faults.warming[0] == name:
                p = p + np.array(faults.warming[1]) * (1.0 - np.exp(-10.0 * i / faults.warming[2]))
            if (name, i) in faults.gross:
                p = p + rng.uniform(0.5e-2, 2e-2, 3)
            p = p + rng.normal(0.0, NOISE[0], 3)
            R = Rotation.from_rotvec(rng.normal(0.0, NOISE[1], 3)).as_matrix() @ R
            w = Rotation.from_matrix(R).as_quat()
            numbers = [*q[i], *p, w[3], *w[:3]]
            lines.append(f"{i},{10 * i},," + ",".join(f"{v:.9f}" for v in numbers) + f",{int(i % 12 == 5)}")
        path = folder / name
        path.mkdir(parents=True)
        document = {
            "schema": "doormill/pose-set/1",
            "robot": "invented",
            "source": "test",
            "model": {"dh": DH, "links": [{"mass": m, "com": list(c)} for m, c in LINKS]},
            "noise": {"position": NOISE[0], "rotation": NOISE[1]},
            "placement": "fitted",
        }
        if not faults.stated:
            del document["noise"]
        (path / "set.yaml").write_text(yaml.safe_dump(document))
        (path / "poses.csv").write_text("\n".join(lines) + "\n")
        folders.append(path)
    return folders


@pytest.fixture(scope="session")
def faults():
    return Faults


@pytest.fixture(scope="session")
def write_pose_sets():
    return write_sets


@pytest.fixture
def invented():
    return {"dh": np.array(DH), "pose": pose_of, "torque": gravity_torque, "noise": NOISE}
