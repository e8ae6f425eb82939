"""Three gear trains of an arm that move together, and what their encoders and drives report.

The links are integrated behind their springs in small steps; gravity loads joint 2 by both links and joint 3 by one,
so a torque is no function of its own angle. A hidden law bends a spring, drags a motor or falsifies a reading.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

RATE, STEPS = 250.0, 6  # samples a second, integration steps a sample
RATIO = (241.3, 259.8, 228.1)
STIFFNESS = (4.2e6, 6.9e6, 3.9e6)  # N m / rad
INERTIA = (420.0, 500.0, 240.0)  # kg m^2
UPPER, FORE = 2600.0, 3300.0  # N m, stretched out
OUT = (-1.5, 0.1)  # rad, stretch of the upper arm, and the fore arm's angle against it
SHORT = 0.06  # damping ratio of a gear


@dataclass(frozen=True)
class Now:
    """One instant: seconds, motor angles behind the gears [rad], their speeds [rad/s], loads [N m] just before."""

    t: float
    angle: tuple[float, float, float]
    speed: tuple[float, float, float]
    load: tuple[float, float, float]


#: Torque of a spring [N m] wound up by an angle [rad], and drag on a motor [N m].
Spring = Callable[[float, Now], float]
Drag = Callable[[Now], float]


@dataclass(frozen=True, eq=False)
class Ride:
    """What happened in every sample: arrays (n,) and (n, 3), SI."""

    t: np.ndarray
    motor: np.ndarray
    speed: np.ndarray
    link: np.ndarray
    torque: np.ndarray


def way(rng: np.random.Generator, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Time and angle (m,) [s, rad] at the steps of integration: moves that overlap, with rests between some."""
    t = np.arange(round(seconds * RATE) * STEPS + 1) / (RATE * STEPS)
    angle, here, begin = np.zeros_like(t), float(rng.uniform(-0.3, 0.3)), float(rng.uniform(0.3, 0.9))
    angle += here
    while begin < seconds - 1.5:
        length = float(rng.uniform(0.9, 2.2))
        length = min(length, seconds - 0.3 - begin)
        goal = float(np.clip(rng.uniform(-1.0, 1.0), here - 0.3 * length, here + 0.3 * length))
        s = np.clip((t - begin) / length, 0.0, 1.0)
        angle += (goal - here) * (10 * s**3 - 15 * s**4 + 6 * s**5)
        begin, here = begin + length * float(rng.uniform(0.7, 1.2)), goal
    return t, angle


def weight(angle: tuple[float, ...] | list[float]) -> tuple[float, float, float]:
    """Torques [N m] that hold the arm at these angles [rad]."""
    fore = FORE * math.cos(angle[1] + OUT[0] + angle[2] + OUT[1])
    return 0.0, UPPER * math.cos(angle[1] + OUT[0]) + fore, 0.8 * fore


def ride(
    rng: np.random.Generator, seconds: float, springs: dict[int, Spring], drags: dict[int, Drag]
) -> Ride:
    """Move the arm; joints without a spring or drag of their own (0 to 2) have the stated spring and none."""
    ways = [way(rng, seconds) for _ in range(3)]
    t = ways[0][0]
    motor = np.column_stack([angle for _, angle in ways])
    dt = float(t[1])
    speed = np.gradient(motor, dt, axis=0)
    load = list(weight(motor[0].tolist()))
    angle = [m - force / k for m, force, k in zip(motor[0].tolist(), load, STIFFNESS, strict=True)]
    rate = [0.0, 0.0, 0.0]
    damper = [2.0 * SHORT * math.sqrt(k * i) for k, i in zip(STIFFNESS, INERTIA, strict=True)]
    links, torques = np.empty_like(motor), np.empty_like(motor)
    angles, speeds = motor.tolist(), speed.tolist()
    for i, moment in enumerate(t.tolist()):
        now = Now(moment, tuple(angles[i]), tuple(speeds[i]), tuple(load))
        holds = weight(angle)
        for k in range(3):
            wound = angles[i][k] - angle[k]
            force = springs[k](wound, now) if k in springs else STIFFNESS[k] * wound
            bend = damper[k] * (speeds[i][k] - rate[k])
            links[i, k] = angle[k]
            load[k] = force + bend
            torques[i, k] = load[k] + (drags[k](now) if k in drags else 0.0)
            rate[k] += dt * (load[k] - holds[k] - 50.0 * rate[k]) / INERTIA[k]
            angle[k] += dt * rate[k]
    pick = slice(None, None, STEPS)
    return Ride(t[pick], motor[pick], speed[pick], links[pick], torques[pick])
