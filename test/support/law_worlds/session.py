"""What a lab does with the robot: postures, approaches, loads, clock and air, one loading a row."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from support.law_worlds.geometry import Hinge, link_frames, turned

#: Name: link that carries it, position in that link's frame [m].
REFLECTORS = {
    "ee": (6, np.array([0.05, 0.0, 0.18])),
    "tip": (6, np.array([-0.12, 0.09, 0.30])),
    "elbow": (3, np.array([0.10, -0.05, 0.12])),
}
SHARES = (0.4, 0.35, 0.25)
#: Sensor to flange axes about flange z [rad].
SENSOR_ROTATION = 0.7688
VISITS, LOADS = 2, 2  # visits of a posture, loadings after each approach
UNSEEN_POSTURES = 6


@dataclass(frozen=True, eq=False)
class Session:
    """All loadings in the order in which they were done, those that are held out among them.

    A stance is one approach and the loadings after it, without any motion between; the approaches of a visit
    come from opposite sides, so a change of angles or directions marks a new stance. Between two loadings
    the robot rests unloaded for at least five times the longest time constant of creep.

    Attributes:
        q: Commanded, shape (n, 6) [rad].
        approach: Last motion of each joint, -1 or +1, shape (n, 6).
        stance: Number of the stance, shape (n,).
        force, couple: The load at the load point, base axes, shape (n, 3) [N, N m].
        reflector: Name, shape (n,).
        t, dt: As in the file, shape (n,) [s]; the load comes at t - dt.
        air: Temperature, shape (n,) [deg C].
        seen: Whether the row is in the set, else it is held out; shape (n,).
        load_point: Flange frame, shape (3,) [m].
    """

    q: np.ndarray
    approach: np.ndarray
    stance: np.ndarray
    force: np.ndarray
    couple: np.ndarray
    reflector: np.ndarray
    t: np.ndarray
    dt: np.ndarray
    air: np.ndarray
    seen: np.ndarray
    load_point: np.ndarray

    @cached_property
    def frames(self) -> np.ndarray:
        """Unloaded, shape (n, 7, 4, 4)."""
        return link_frames(self.q)

    @cached_property
    def links(self) -> np.ndarray:
        """The link that carries the row's reflector, shape (n,)."""
        return np.array([REFLECTORS[name][0] for name in self.reflector])

    @cached_property
    def points(self) -> np.ndarray:
        """The row's reflector, unloaded, base frame, shape (n, 3) [m]."""
        local = np.array([REFLECTORS[name][1] for name in self.reflector])
        T = self.frames[np.arange(len(self.q)), self.links]
        return np.einsum("nij,nj->ni", T[:, :3, :3], local) + T[:, :3, 3]

    def torque(self, hinge: Hinge) -> np.ndarray:
        """Of the load about a hinge, shape (n,) [N m], on the undeformed robot."""
        axis, point = hinge.line(self.frames)
        flange = self.frames[:, 6]
        at = flange[:, :3, :3] @ self.load_point + flange[:, :3, 3]
        return np.sum(axis * (self.couple + np.cross(at - point, self.force)), axis=1)

    def moved(self, turns: list[tuple[Hinge, np.ndarray]]) -> np.ndarray:
        """Displacement of the reflectors when hinges turn by angles (n,) [rad], shape (n, 3) [m].

        Finite turns, the outermost first: those further in carry it along.
        """
        now = self.points
        for hinge, angle in sorted(turns, key=lambda turn: -turn[0].order):
            axis, point = hinge.line(self.frames)
            carried = np.where(self.links >= hinge.link, angle, 0.0)
            now = point + turned(axis, carried, now - point)
        return now - self.points

    def in_sensor_axes(self) -> np.ndarray:
        """The load as an honest sensor reads it, shape (n, 6) [N, N m]."""
        c, s = np.cos(SENSOR_ROTATION), np.sin(SENSOR_ROTATION)
        R = self.frames[:, 6, :3, :3] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return np.hstack([np.einsum("nji,nj->ni", R, v) for v in (self.force, self.couple)])


def draw_session(rng: np.random.Generator) -> Session:
    """14 to 24 postures and six to hold out, each visited twice in an order of chance."""
    seen_postures = int(rng.integers(14, 25))
    postures = seen_postures + UNSEEN_POSTURES
    middle, half = np.array([0.0, 0.15, -0.3, 0.0, 0.3, 0.0]), np.array([1.4, 0.75, 0.7, 1.7, 1.3, 1.7])
    angles = middle + half * rng.uniform(-1.0, 1.0, (postures, 6))
    visits = rng.permutation(np.repeat(np.arange(postures), VISITS))
    side = rng.choice([-1.0, 1.0], (len(visits), 1, 6)) * np.array([1.0, -1.0])[:, None]
    row = np.repeat(visits, 2 * LOADS)
    n = len(row)
    size = rng.uniform(150.0, 600.0, (n, 1))
    if rng.random() < 0.5:  # a rope along an axis of the base, else a pull from anywhere with a couple
        way, couple = np.vstack([np.eye(3), -np.eye(3)])[rng.integers(6, size=n)], np.zeros((n, 3))
    else:
        way, couple = rng.normal(size=(n, 3)), rng.normal(0.0, 30.0, (n, 3))
    dt = np.exp(rng.uniform(np.log(5.0), np.log(200.0), n))
    t = np.cumsum(dt + rng.uniform(150.0, 300.0, n))
    swing = rng.uniform(1.5, 3.0) * np.sin(2 * np.pi * (t / rng.uniform(9e3, 2e4) + rng.random()))
    return Session(
        q=angles[row],
        approach=np.repeat(side.reshape(-1, 6), LOADS, axis=0),
        stance=np.repeat(np.arange(2 * len(visits)), LOADS),
        force=size * way / np.linalg.norm(way, axis=1, keepdims=True),
        couple=couple,
        reflector=rng.choice(list(REFLECTORS), n, p=SHARES),
        t=t,
        dt=dt,
        air=21.0 + swing + rng.normal(0.0, 0.1, n),
        seen=row < seen_postures,
        load_point=np.array([*rng.uniform(-0.08, 0.08, 2), 0.18]),
    )
