"""Motion sets of an arm that obeys a hidden law without a name, and the recording after it of the same arm."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from support.motion_laws.laws import LAWS, Law
from support.motion_laws.train import INERTIA, RATE, RATIO, STIFFNESS, Drag, Ride, Spring, ride

NOISE = (1.0e-5, 1.0e-6, 5.0)  # link, motor [rad], torque [N m]
SECONDS = 14.0
WEAKEST, STRONGEST = 4.0, 20.0  # times the link encoder's noise


@dataclass(frozen=True)
class Beside:
    """A named cause beside the law: its name, its joint (index) and its size."""

    name: str
    joint: int
    size: float


@dataclass(frozen=True, eq=False)
class World:
    """One arm.

    Attributes:
        seed: What it was drawn from; the law by seed % 12, a named cause beside it in every other dozen.
        beside: That cause, or None.
        times: Root mean square of the law over the noise, about.
    """

    seed: int
    beside: Beside | None
    times: float

    @property
    def law(self) -> Law:
        """The hidden law; a new one for every recording, since a drag has a memory."""
        rng = np.random.default_rng([self.seed, 5])
        return LAWS[self.seed % len(LAWS)](rng, self.times * NOISE[0])

    def ride(self, recording: int) -> Ride:
        """What the arm does in a recording."""
        law = self.law
        springs: dict[int, Spring] = {} if law.spring is None else {law.joint: law.spring}
        drags: dict[int, Drag] = {} if law.drag is None else {law.joint: law.drag}
        if self.beside and self.beside.name == "joint_stiffness":
            softer = STIFFNESS[self.beside.joint] * self.beside.size
            springs[self.beside.joint] = lambda wound, now: softer * wound
        return ride(np.random.default_rng([self.seed, 6, recording]), SECONDS, springs, drags)

    def write(self, folder: Path, recording: int = 0) -> Path:
        """The motion set of one recording."""
        done, law = self.ride(recording), self.law
        rng = np.random.default_rng([self.seed, 7, recording])
        n = len(done.t)
        links = done.link.copy()
        if law.reading is not None:
            links[:, law.joint] += law.reading(done)
        if self.beside and self.beside.name == "encoder_scale":
            links[:, self.beside.joint] *= self.beside.size
        if self.beside and self.beside.name == "time_skew":
            k = self.beside.joint
            links[:, k] = np.interp(done.t - self.beside.size, done.t, links[:, k])
        names, columns = ["t"], [done.t]
        for letter, values, noise in (
            ("m", done.motor, NOISE[1]),
            ("l", links, NOISE[0]),
            ("tau", done.torque, NOISE[2]),
        ):
            for k in range(3):
                start = rng.normal(0.0, 1e-3) if letter == "l" else 0.0
                names.append(f"{letter}{k + 1}")
                columns.append(values[:, k] + start + rng.normal(0.0, noise, n))
        names += [f"r{k}" for k in range(1, 7)]
        columns += [done.motor[:, k] if k < 3 else np.zeros(n) for k in range(6)]
        folder.mkdir(parents=True, exist_ok=True)
        table = np.column_stack(columns)
        np.savetxt(
            folder / "samples.csv", table, fmt="%.9g", delimiter=",", header=",".join(names), comments=""
        )
        document = {
            "schema": "doormill/motion-set/1",
            "robot": "simulated arm",
            "source": "simulated gear trains",
            "rate": RATE,
            "joints": [1, 2, 3],
            "model": {
                "gear_ratio": list(RATIO),
                "joint_stiffness": list(STIFFNESS),
                "motor_inertia": [i / r**2 for i, r in zip(INERTIA, RATIO, strict=True)],
            },
            "noise": dict(zip(("link", "motor", "torque"), NOISE, strict=True)),
        }
        (folder / "set.yaml").write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
        return folder

    @property
    def truth(self) -> dict[str, Any]:
        """What is hidden, and what may be named of it."""
        law = self.law
        where = f"joint {law.joint + 1}"
        named = [(name, where) for name in law.beside]
        if self.beside:
            named.append((self.beside.name, f"joint {self.beside.joint + 1}"))
        return {
            "seed": self.seed,
            "law": law.name,
            "where": where,
            "driver": law.driver,
            "also": list(law.also),
            "amplitude": self.times,
            "may_be_named": named,
            "beside": None if self.beside is None else self.beside.name,
        }


def draw(seed: int) -> World:
    """The world of a seed."""
    rng = np.random.default_rng([seed, 4])
    times = float(np.exp(rng.uniform(np.log(WEAKEST), np.log(STRONGEST))))
    if (seed // len(LAWS)) % 2 == 0:
        return World(seed, None, times)
    sized = {
        "joint_stiffness": float(rng.uniform(0.6, 0.85)),
        "encoder_scale": 1.0 + float(rng.uniform(2e-4, 6e-4)),
        "time_skew": float(rng.uniform(3e-4, 8e-4)),
    }
    name = str(rng.choice(list(sized)))
    law = World(seed, None, times).law.joint
    joint = int(rng.choice([k for k in range(3) if k != law]))
    return World(seed, Beside(name, joint, sized[name]), times)
