"""Pose sets of an invented robot that obeys a hidden law without a name, and a later series of the same robot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from support.pose_laws.laws import LAWS, Law, Session
from support.pose_sets import DH, LINKS, NOISE, pose_of

WEAKEST, STRONGEST = 3.0, 12.0  # times the noise of a position
LOW = (-2.5, -2.6, -2.2, -2.8, -2.3, -2.9)
HIGH = (2.5, -0.4, 2.2, 2.8, 2.3, 2.9)


@dataclass(frozen=True, eq=False)
class World:
    """One robot: the law by seed % 10, with a wrong link length in every other ten.

    Attributes:
        seed: What it was drawn from.
        law: What is hidden.
        times: Root mean square of the displacement's components over the noise, about.
        longer: What a link is longer than stated, by its index, shape (6,) [m].
    """

    seed: int
    law: Law
    times: float
    longer: np.ndarray

    def session(self, rows: int, part: int) -> Session:
        """Postures of a series; the second stands between those of the first in time."""
        rng = np.random.default_rng([self.seed, 15, part])
        return Session(rng.uniform(LOW, HIGH, (rows, 6)), 12.0 * np.linspace(0.0, 300.0, rows))

    def flanges(self, session: Session, size: float) -> np.ndarray:
        """T_base_flange of a session with `size` of the law, shape (n, 4, 4)."""
        dh = np.array(DH)
        dh[:, 2] += self.longer
        amount = size * self.law.amount(session) if size else np.zeros(len(session.q))
        found = []
        for q, much in zip(session.q, amount, strict=True):
            true = q.copy()
            if self.law.joint > 0:
                true[self.law.joint - 1] += much
            T = pose_of(true, dh)
            moved = np.eye(4)
            if self.law.joint == 0:
                moved[:3, :3] = Rotation.from_rotvec(much * np.array(self.law.axis)).as_matrix()
            elif self.law.joint < 0:
                moved[:3, 3] = much * np.array(self.law.axis)
            found.append(moved @ T)
        return np.array(found)

    def size(self, session: Session) -> float:
        """Of the law [rad or m a unit], so that it displaces by `times` the noise."""
        bare, tried = self.flanges(session, 0.0), self.flanges(session, 1e-6)
        moved = tried[:, :3, 3] - bare[:, :3, 3]
        return 1e-6 * self.times * NOISE[0] / float(np.sqrt(np.mean((moved - moved.mean(axis=0)) ** 2)))

    def write(self, folder: Path, rows: int = 240, part: int = 0) -> Path:
        """One series, with a placement of its own."""
        rng = np.random.default_rng([self.seed, 16, part])
        base, target = np.eye(4), np.eye(4)
        base[:3, :3], base[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.uniform(-3.0, 3.0, 3)
        target[:3, :3], target[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.uniform(-0.15, 0.15, 3)
        session = self.session(rows, part)
        flanges = self.flanges(session, self.size(self.session(100, 0)))
        lines = ["row,t,temperature,q1,q2,q3,q4,q5,q6,x,y,z,qw,qx,qy,qz,placement"]
        for i, T_base_flange in enumerate(flanges):
            T = base @ T_base_flange @ target
            p = T[:3, 3] + rng.normal(0.0, NOISE[0], 3)
            R = Rotation.from_rotvec(rng.normal(0.0, NOISE[1], 3)).as_matrix() @ T[:3, :3]
            w = Rotation.from_matrix(R).as_quat()
            numbers = [*session.q[i], *p, w[3], *w[:3]]
            lines.append(
                f"{i},{session.t[i]:.1f},," + ",".join(f"{v:.9f}" for v in numbers) + f",{int(i % 10 == 5)}"
            )
        folder.mkdir(parents=True, exist_ok=True)
        document = {
            "schema": "doormill/pose-set/1",
            "robot": "invented",
            "source": "test",
            "model": {"dh": DH, "links": [{"mass": m, "com": list(c)} for m, c in LINKS]},
            "noise": {"position": NOISE[0], "rotation": NOISE[1]},
            "placement": "fitted",
        }
        (folder / "set.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
        (folder / "poses.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        return folder

    @property
    def truth(self) -> dict[str, Any]:
        """What is hidden, and what may be named of it."""
        # A link's own offset turns the joint of its number.
        may = [
            (name, self.law.where.replace("joint", "link") if name == "link_geometry" else self.law.where)
            for name in self.law.beside
        ]
        may += [("link_geometry", f"link {k + 1}") for k in range(6) if self.longer[k]]
        return {
            "seed": self.seed,
            "law": self.law.name,
            "where": self.law.where,
            "driver": self.law.driver,
            "also": list(self.law.also),
            "amplitude": self.times,
            "may_be_named": may,
            "beside": "link_geometry" if np.any(self.longer) else None,
        }


def draw(seed: int) -> World:
    """The world of a seed."""
    rng = np.random.default_rng([seed, 14])
    law = LAWS[seed % len(LAWS)](rng)
    times = float(np.exp(rng.uniform(np.log(WEAKEST), np.log(STRONGEST))))
    longer = np.zeros(6)
    if (seed // len(LAWS)) % 2:
        longer[int(rng.choice([1, 2]))] = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(2e-4, 6e-4))
    return World(seed, law, times, longer)
