"""Laws that no cause of the contract's list for moving joints names, each of unit size 1 rad of error or so.

A law gives what it changes: a spring, a drag, or a reading. Sizes are the root mean square it is meant to leave [rad].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from support.motion_laws.train import RATE, STIFFNESS, Drag, Now, Ride, Spring

#: Error of a link encoder (n,) [rad].
Reading = Callable[[Ride], np.ndarray]


@dataclass(frozen=True, eq=False)
class Law:
    """A law in one joint.

    Attributes:
        name: Of the law.
        joint: Index 0 to 2.
        driver: As the contract words it; `also` are as true.
        spring, drag, reading: What it changes.
        beside: Names of causes that are in it too, at its joint: a friction that falls is a friction.
    """

    name: str
    joint: int
    driver: str
    also: tuple[str, ...] = ()
    spring: Spring | None = None
    drag: Drag | None = None
    reading: Reading | None = None
    beside: tuple[str, ...] = ()


class Bristle:
    """Slides where the speed has one sign, winds where it turns: -1 to 1."""

    def __init__(self, length: float = 4e-4) -> None:
        """Start half wound; `length` [rad] winds it."""
        self._length, self._state, self._before = length, 0.0, math.nan

    def at(self, angle: float) -> float:
        """After a move to this angle [rad]."""
        step = 0.0 if math.isnan(self._before) else angle - self._before
        self._before = angle
        self._state = min(max(self._state + step / self._length, -1.0), 1.0)
        return self._state


def _loaded(rng: np.random.Generator) -> int:
    """A joint that carries weight."""
    return int(rng.integers(1, 3))


def _two(rng: np.random.Generator) -> tuple[int, int]:
    """Two joints, the first of which carries weight."""
    joint = _loaded(rng)
    return joint, int(rng.choice([k for k in range(3) if k != joint]))


def _solve(twist: Callable[[float, Now], float]) -> Spring:
    """A spring from the angle [rad] that a torque winds it by, which grows with the torque: steps of a secant."""

    def spring(wound: float, now: Now) -> float:
        force, slope = 0.0, 4.0e6
        left = wound - twist(force, now)
        for _ in range(40):
            if abs(left) < 1e-10:
                return force
            step = slope * left
            force += step
            before, left = left, wound - twist(force, now)
            # Flatter than that no spring here is; where two steps lie on both sides of a bend the secant may be.
            slope = min(max(step / (before - left), 2e5), 2e7) if before != left else slope
        raise ArithmeticError(f"no torque found that winds a spring by {wound} rad")

    return spring


def cooling_friction(rng: np.random.Generator, size: float) -> Law:
    """A drag that falls while oil warms."""
    k, fall = int(rng.integers(3)), float(rng.uniform(3.0, 7.0))
    bristle, most = Bristle(), 2.2 * size * STIFFNESS[k]

    def drag(now: Now) -> float:
        return most * math.exp(-now.t / fall) * bristle.at(now.angle[k])

    return Law("cooling friction", k, "time", ("temperature",), drag=drag, beside=("joint_friction",))


def tight_spot(rng: np.random.Generator, size: float) -> Law:
    """A drag that sits in one place of the turn."""
    k, place, width = int(rng.integers(3)), float(rng.uniform(-0.4, 0.4)), float(rng.uniform(0.15, 0.3))
    bristle, most = Bristle(), 2.0 * size * STIFFNESS[k]

    def drag(now: Now) -> float:
        return most * math.exp(-(((now.angle[k] - place) / width) ** 2)) * bristle.at(now.angle[k])

    return Law("tight spot", k, "own angle", drag=drag, beside=("joint_friction",))


def neighbour_spring(rng: np.random.Generator, size: float) -> Law:
    """A spring that another joint's angle softens."""
    k, other = _two(rng)
    share, phase = size * STIFFNESS[k] / 900.0, float(rng.uniform(-0.5, 0.5))

    def twist(force: float, now: Now) -> float:
        return force / STIFFNESS[k] * (1.0 + share * math.sin(2.0 * now.angle[other] + phase))

    return Law(
        "neighbour spring",
        k,
        f"angle of joint {other + 1}",
        spring=_solve(twist),
        beside=("joint_stiffness",),
    )


def one_sided_spring(rng: np.random.Generator, size: float) -> Law:
    """A spring that yields more one way."""
    k, side = _loaded(rng), float(rng.choice([-1.0, 1.0]))
    more = size * STIFFNESS[k] / 500.0

    def twist(force: float, now: Now) -> float:
        return force / STIFFNESS[k] * (1.0 + (more if side * force > 0.0 else 0.0))

    return Law(
        "one-sided spring",
        k,
        "torque sign",
        ("own torque",),
        spring=_solve(twist),
        beside=("joint_stiffness",),
    )


def stiffening(rng: np.random.Generator, size: float) -> Law:
    """A spring that gives way less the more it is loaded, both ways."""
    k = _loaded(rng)
    more = size * STIFFNESS[k] / 500.0

    def twist(force: float, now: Now) -> float:
        return force / STIFFNESS[k] + more * 900.0 / STIFFNESS[k] * math.tanh(force / 900.0)

    return Law(
        "stiffening", k, "own torque", ("torque sign",), spring=_solve(twist), beside=("joint_stiffness",)
    )


def loaded_wave(rng: np.random.Generator, size: float) -> Law:
    """A wave of the gear that a load enlarges."""
    k, waves, phase = _loaded(rng), int(rng.integers(3, 31)), float(rng.uniform(0.0, 6.28))
    amplitude = 1.4 * size / 1500.0

    def reading(ride: Ride) -> np.ndarray:
        return amplitude * ride.torque[:, k] * np.cos(waves * ride.motor[:, k] + phase)

    return Law("loaded wave", k, "own angle", ("own torque",), reading=reading)


def swift_error(rng: np.random.Generator, size: float) -> Law:
    """A reading that fails with the square of the speed."""
    k = int(rng.integers(3))

    def reading(ride: Ride) -> np.ndarray:
        return size / 0.08 * ride.speed[:, k] ** 2

    return Law("swift error", k, "speed", reading=reading)


def loaded_lag(rng: np.random.Generator, size: float) -> Law:
    """A lag that grows with the load."""
    k = _loaded(rng)

    def reading(ride: Ride) -> np.ndarray:
        return -size / 0.2 * np.abs(ride.torque[:, k]) / 2500.0 * ride.speed[:, k]

    return Law(
        "loaded lag", k, "own torque", ("speed",), reading=reading, beside=("time_skew", "joint_damping")
    )


def drifting_encoder(rng: np.random.Generator, size: float) -> Law:
    """A reading that settles after switching on."""
    k, settles = int(rng.integers(3)), float(rng.uniform(2.0, 8.0))

    def reading(ride: Ride) -> np.ndarray:
        return 3.5 * size * np.exp(-ride.t / settles)

    return Law("drifting encoder", k, "time", ("temperature",), reading=reading)


def crosstalk(rng: np.random.Generator, size: float) -> Law:
    """A cable that another joint pulls."""
    k, other = (int(j) for j in rng.permutation(3)[:2])

    def reading(ride: Ride) -> np.ndarray:
        return size / 0.3 * np.sin(ride.motor[:, other] + 0.3)

    return Law("crosstalk", k, f"angle of joint {other + 1}", reading=reading)


def bending_neighbour(rng: np.random.Generator, size: float) -> Law:
    """A housing that another joint's torque bends."""
    other = _loaded(rng)
    k = int(rng.choice([j for j in range(3) if j != other]))

    def reading(ride: Ride) -> np.ndarray:
        return size / 1400.0 * ride.torque[:, other]

    return Law("bending neighbour", k, f"torque of joint {other + 1}", reading=reading)


def creeping_spring(rng: np.random.Generator, size: float) -> Law:
    """A spring that goes on yielding after the load came."""
    k, settles = _loaded(rng), float(rng.uniform(0.5, 2.5))

    def reading(ride: Ride) -> np.ndarray:
        late = np.empty(len(ride.t))
        felt = float(ride.torque[0, k])
        for i, torque in enumerate(ride.torque[:, k].tolist()):
            felt += (torque - felt) / (RATE * settles)
            late[i] = felt
        return -size / 700.0 * late

    return Law(
        "creeping spring",
        k,
        "time under load",
        ("own torque",),
        reading=reading,
        beside=("joint_stiffness", "joint_damping"),
    )


LAWS: tuple[Callable[[np.random.Generator, float], Law], ...] = (
    cooling_friction,
    neighbour_spring,
    loaded_wave,
    swift_error,
    one_sided_spring,
    loaded_lag,
    tight_spot,
    drifting_encoder,
    crosstalk,
    bending_neighbour,
    creeping_spring,
    stiffening,
)
