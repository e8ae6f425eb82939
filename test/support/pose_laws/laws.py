"""Laws that no cause for poses names: what each turns or shifts beyond the simulation, of unit size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from support.pose_sets import gravity_torque


@dataclass(frozen=True, eq=False)
class Session:
    """Postures in the order in which they were measured.

    Attributes:
        q: Joint angles, shape (n, 6) [rad].
        t: Shape (n,) [s].
    """

    q: np.ndarray
    t: np.ndarray

    def torque(self, joint: int) -> np.ndarray:
        """Of gravity about a joint (1 to 6), shape (n,) [N m]."""
        return np.array([gravity_torque(row, joint) for row in self.q])

    def came(self, joint: int) -> np.ndarray:
        """From which side a joint came, -1 or 1, shape (n,); 0 in the first row."""
        return np.sign(np.diff(self.q[:, joint - 1], prepend=self.q[0, joint - 1]))

    def hours(self) -> np.ndarray:
        """Share of the session that has passed, shape (n,)."""
        return self.t / self.t[-1]


@dataclass(frozen=True, eq=False)
class Law:
    """One law.

    Attributes:
        name: Of the law.
        joint: That turns (1 to 6), or 0 for a base that tilts and -1 for one that shifts.
        driver: As the contract words it; `also` are as true.
        amount: By how much, before it is sized, shape (n,).
        beside: Names of causes that are in it too, at its place.
        axis: About or along which a base moves.
    """

    name: str
    joint: int
    driver: str
    amount: Callable[[Session], np.ndarray]
    also: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)

    @property
    def where(self) -> str:
        """In the contract's words."""
        return f"joint {self.joint}" if self.joint > 0 else "base"


def _sagging(rng: np.random.Generator) -> int:
    return int(rng.integers(2, 4))


def _other(rng: np.random.Generator, joint: int) -> int:
    return int(rng.choice([k for k in range(1, 6) if k != joint]))


def neighbour_sag(rng: np.random.Generator) -> Law:
    """A joint sags more where another joint stands so or so."""
    k = _sagging(rng)
    other, phase = _other(rng, k), float(rng.uniform(0.0, 6.28))
    return Law(
        "neighbour sag",
        k,
        f"angle of joint {other}",
        lambda s: s.torque(k) * np.sin(s.q[:, other - 1] + phase),
        beside=("joint_sag",),
    )


def tiring(rng: np.random.Generator) -> Law:
    """A joint goes astray fast at first, and on."""
    k, early = int(rng.integers(1, 6)), float(rng.uniform(0.01, 0.05))
    return Law(
        "tiring", k, "time", lambda s: np.log1p(s.hours() / early), beside=("thermal_drift", "link_geometry")
    )


def cross_play(rng: np.random.Generator) -> Law:
    """A joint stands elsewhere by the side from which another came."""
    k = int(rng.integers(1, 6))
    other = _other(rng, k)
    return Law(
        "cross play", k, "direction", lambda s: s.came(other), also=(f"angle of joint {other}", "path")
    )


def coupled_wrist(rng: np.random.Generator) -> Law:
    """A joint is turned along by one that is not its neighbour, with a wave in it."""
    k, other = ((2, 4), (2, 5), (3, 5), (4, 2), (5, 2), (5, 3), (4, 1), (3, 1))[int(rng.integers(8))]
    phase = float(rng.uniform(0.0, 6.28))
    return Law(
        "coupled wrist", k, f"angle of joint {other}", lambda s: np.sin(2.0 * s.q[:, other - 1] + phase)
    )


def rocking_base(rng: np.random.Generator) -> Law:
    """The base tilts as the arm bends."""
    other, phase = int(rng.integers(2, 4)), float(rng.uniform(0.0, 6.28))
    angle = float(rng.uniform(0.0, 6.28))
    return Law(
        "rocking base",
        0,
        f"angle of joint {other}",
        lambda s: np.sin(2.0 * s.q[:, other - 1] + phase),
        axis=(float(np.cos(angle)), float(np.sin(angle)), 0.0),
    )


def one_sided_sag(rng: np.random.Generator) -> Law:
    """A joint sags one way only."""
    k, side = _sagging(rng), float(rng.choice([-1.0, 1.0]))
    return Law(
        "one-sided sag",
        k,
        "torque sign",
        lambda s: np.maximum(side * s.torque(k), 0.0),
        also=("own torque",),
        beside=("joint_sag",),
    )


def saturating_sag(rng: np.random.Generator) -> Law:
    """A joint gives way at once, and hardly more under more."""
    k = _sagging(rng)
    return Law(
        "saturating sag",
        k,
        "own torque",
        lambda s: np.tanh(s.torque(k) / 15.0),
        also=("torque sign",),
        beside=("joint_sag",),
    )


def carried_torque(rng: np.random.Generator) -> Law:
    """A joint's reading follows the torque of another."""
    other = _sagging(rng)
    k = int(rng.choice([1, 4, 5]))
    return Law("carried torque", k, f"torque of joint {other}", lambda s: s.torque(other))


def wandering_base(rng: np.random.Generator) -> Law:
    """The base shifts to and fro through the day."""
    turns, phase = float(rng.uniform(1.5, 3.0)), float(rng.uniform(0.0, 6.28))
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    return Law(
        "wandering base",
        -1,
        "time",
        lambda s: np.sin(2.0 * np.pi * turns * s.hours() + phase),
        also=("temperature",),
        beside=("thermal_drift",),
        axis=(float(axis[0]), float(axis[1]), float(axis[2])),
    )


def drying_sag(rng: np.random.Generator) -> Law:
    """A joint sags more while the day goes on."""
    k = _sagging(rng)
    return Law(
        "drying sag",
        k,
        "time",
        lambda s: s.torque(k) * s.hours(),
        also=("temperature",),
        beside=("joint_sag",),
    )


LAWS: tuple[Callable[[np.random.Generator], Law], ...] = (
    neighbour_sag,
    tiring,
    cross_play,
    coupled_wrist,
    rocking_base,
    one_sided_sag,
    carried_torque,
    wandering_base,
    saturating_sag,
    drying_sag,
)
