"""Pose sets of invented arms of six or seven joints whose target a tracker sees as a point.

Kinematics and statics of their own: elementary rotations and shifts one after the other, torques by differences of the
energy. Nothing here comes from the model that is questioned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml

#: Seven joints with crossing axes, lengths like those of a light arm; theta_offset, d, a, alpha.
SEVEN = [
    [0.0, 0.350, 0.0, -np.pi / 2],
    [0.0, 0.0, 0.0, np.pi / 2],
    [0.0, 0.410, 0.0, np.pi / 2],
    [0.0, 0.0, 0.0, -np.pi / 2],
    [0.0, 0.395, 0.0, -np.pi / 2],
    [0.0, 0.0, 0.0, np.pi / 2],
    [0.0, 0.130, 0.0, 0.0],
]
#: Six joints of a large arm with two parallel axes.
SIX = [
    [0.0, 0.680, 0.320, -np.pi / 2],
    [-np.pi / 2, 0.0, 0.980, 0.0],
    [0.0, 0.0, 0.200, -np.pi / 2],
    [0.0, 0.885, 0.0, np.pi / 2],
    [0.0, 0.0, 0.0, -np.pi / 2],
    [0.0, 0.150, 0.0, 0.0],
]
COLUMN = {"theta": 0, "d": 1, "a": 2, "alpha": 3}


@dataclass
class Arm:
    """What stands in the room and what was measured of it; lists of (joint or link, ...)."""

    dh: Sequence[Sequence[float]] = field(default_factory=lambda: SEVEN)
    masses: Sequence[float] = (4.0, 4.0, 3.0, 2.7, 1.7, 1.8, 0.3)  # kg, half way between the frames
    stated: bool = True  # whether the set states them
    geometry: Sequence[tuple[int, str, float]] = ()
    sag: Sequence[tuple[int, float]] = ()  # joint, rad / (N m)
    periodic: Sequence[tuple[int, int, float, float]] = ()  # joint, order, amplitude, phase
    strange: float = 0.0  # joint errors that no library holds: rad
    down: Sequence[float] = (0.0, 0.0, -1.0)  # along gravity, base axes
    load: tuple[float, Sequence[float]] | None = None  # kg and place in the flange that no set states, m
    scale: float = 0.0  # by which the tracker has all lengths too long
    gross: Sequence[tuple[str, int]] = ()
    noise: float = 1.5e-5
    reach: float = 2.0  # of every joint, rad
    names: Sequence[str] = ("only",)
    same: dict[str, str] = field(default_factory=dict)  # set and the one whose placement it has
    placed: bool = True  # whether sets mark rows for their placement


def turn(axis: str, angle: np.ndarray) -> np.ndarray:
    """Rotations about x, y or z, shape (n, 3, 3)."""
    angle = np.asarray(angle)
    c, s, one, none = np.cos(angle), np.sin(angle), np.ones_like(angle), np.zeros_like(angle)
    rows = {
        "x": [one, none, none, none, c, -s, none, s, c],
        "y": [c, none, s, none, one, none, -s, none, c],
        "z": [c, -s, none, s, c, none, none, none, one],
    }
    return np.stack(rows[axis], axis=-1).reshape(*angle.shape, 3, 3)


def along(q: np.ndarray, dh: np.ndarray, beta: dict[int, float]) -> tuple[list[np.ndarray], np.ndarray]:
    """Origins of the frames 0 to J, shape (n, 3) each, and the rotation of the flange."""
    n = len(q)
    R, p = np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3))
    origins = [p]
    for k, (theta, d, a, alpha) in enumerate(dh):
        R = R @ turn("z", q[:, k] + theta)
        p = p + R @ np.array([a, 0.0, d])
        R = R @ turn("x", np.full(n, alpha)) @ turn("y", np.full(n, beta.get(k + 1, 0.0)))
        origins.append(p)
    return origins, R


def energy(q: np.ndarray, arm: Arm) -> np.ndarray:
    """Potential energy with the nominal lengths, shape (n,) [J]."""
    origins, R = along(q, np.array(arm.dh), {})
    down = np.array(arm.down) / np.linalg.norm(arm.down)
    weights = [(mass, 0.5 * (a + b)) for mass, (a, b) in zip(arm.masses, pairwise(origins), strict=False)]
    if arm.load is not None:
        weights.append((arm.load[0], origins[-1] + R @ np.array(arm.load[1])))
    return -9.80665 * sum(mass * (p @ down) for mass, p in weights)


def torque(q: np.ndarray, joint: int, arm: Arm) -> np.ndarray:
    """Generalised force of gravity on a joint, shape (n,) [N m]."""
    h = np.zeros(q.shape[1])
    h[joint - 1] = 1e-5
    return -(energy(q + h, arm) - energy(q - h, arm)) / 2e-5


def centres(arm: Arm) -> list[list[float]]:
    """Centres of mass in the frames of their links: half way back to the frame before, whatever the joint's angle."""
    found = []
    for _, d, a, alpha in arm.dh:
        back = turn("x", np.array(alpha)).T @ np.array([-0.5 * a, 0.0, -0.5 * d])
        found.append([float(v) for v in back])
    return found


def write_arm(folder: Path, arm: Arm, rows: int, seed: int) -> list[Path]:
    """Write one set for every name of the arm."""
    rng = np.random.default_rng(seed)
    dh = np.array(arm.dh)
    wrong, beta = dh.copy(), {}
    for link, name, size in arm.geometry:
        if name == "beta":
            beta[link] = size
        else:
            wrong[link - 1, COLUMN[name]] += size
    placements: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
    folders = []
    for name in arm.names:
        q = rng.uniform(-arm.reach, arm.reach, (rows, len(dh)))
        own = (turn("z", rng.uniform(-3, 3)) @ turn("x", rng.uniform(-3, 3)) @ turn("z", rng.uniform(-3, 3)),
               rng.uniform(-3.0, 3.0, 3), rng.uniform(-0.15, 0.15, 3))  # fmt: skip
        R_base, p_base, target = placements.setdefault(arm.same.get(name, name), own)
        true = q.copy()
        for joint, order, size, phase in arm.periodic:
            true[:, joint - 1] += size * np.cos(order * q[:, joint - 1] - phase)
        for joint, compliance in arm.sag:
            true[:, joint - 1] += compliance * torque(q, joint, arm)
        for k in range(len(dh) - 1):
            true[:, k] += arm.strange * np.sin(3.0 * q[:, k] * q[:, k + 1] + k)
        origins, R = along(true, wrong, beta)
        p = ((origins[-1] + R @ target) @ R_base.T + p_base) * (1.0 + arm.scale)
        p += rng.normal(0.0, arm.noise, (rows, 3))
        for where, row in arm.gross:
            if where == name:
                p[row] += rng.uniform(5e-3, 2e-2, 3)
        joints = ",".join(f"q{k + 1}" for k in range(len(dh)))
        lines = [f"row,t,temperature,{joints},x,y,z,placement"]
        for i in range(rows):
            numbers = ",".join(f"{v:.9f}" for v in [*q[i], *p[i]])
            lines.append(f"{i},,,{numbers},{int(arm.placed and i % 12 == 5)}")
        path = folder / name
        path.mkdir(parents=True)
        model: dict[str, object] = {"dh": [[float(v) for v in row] for row in arm.dh]}
        if arm.stated:
            pairs = zip(arm.masses, centres(arm), strict=False)
            model["links"] = [{"mass": m, "com": c} for m, c in pairs]
        document = {
            "schema": "doormill/pose-set/1",
            "robot": "invented",
            "source": "test",
            "model": model,
            "noise": {"position": arm.noise},
            "placement": f"same as {arm.same[name]}" if name in arm.same else "fitted",
        }
        (path / "set.yaml").write_text(yaml.safe_dump(document))
        (path / "poses.csv").write_text("\n".join(lines) + "\n")
        folders.append(path)
    return folders


@pytest.fixture(scope="session")
def write_arm_sets() -> Callable[..., list[Path]]:
    return write_arm


@pytest.fixture(scope="session")
def arm() -> type[Arm]:
    return Arm
