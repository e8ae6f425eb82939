"""Recordings of moving joints from a simulated gear train, with effects hidden in it; shares no law with any diagnosis.

Every joint is a motor that follows its command, a gear with a spring, and a link that swings on it: Newton's equation
of the link is integrated in small steps. What the encoders and the drive report is read off afterwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import yaml

RATE = 250.0  # Hz
STEPS = 8  # integration steps a sample
RATIO = (256.857, 267.429, 252.333)
STIFFNESS = (4.58e6, 7.52e6, 4.10e6)  # N m / rad
ROTOR = (0.009, 0.012, 0.012)  # inertia of the motors, kg m^2
INERTIA = (380.0, 520.0, 260.0)  # of the link, kg m^2
GRAVITY = (0.0, 5000.0, 4000.0)  # N m, of an arm that stretches out at LEVEL
LEVEL = -1.2  # rad
BEARING = 60.0  # drag on the link, N m s / rad
DAMPING_RATIO = 0.04  # of the gear itself


@dataclass(frozen=True)
class Gear:
    """What one gear train is made of; every default is what a perfect simulation assumes.

    Attributes:
        stiffness: Of the spring over the published one.
        gap: Play between motor and link, behind the motor [rad].
        friction: Torque that the motor needs to slide [N m], reached after `bristle` [rad].
        viscous: The same by speed [N m s / rad].
        tooth: Amplitude [rad], phase [rad], waves a turn of the motor: the gear's own error.
        ruler: Amplitude [rad], phase [rad], waves a turn of the joint: the link encoder's error.
        scale: Of the link encoder.
        late: By how much the link encoder is read late [s].
        hardening: Share by which the spring stiffens at 3000 N m: a law without a name.
        warming: Drift of the link encoder [rad / s]: one without a name.
        crosstalk: Link encoder per angle of the next joint [rad / rad]: one without a name.
        rotor: Motors of the published inertia that the torque speeds up besides the link.
        filtered: Time constant of a filter of first order behind the link encoder [s].
        damper: Beside the spring [N m s / rad].
        stale, drive_filter: By how much the torque is read late, and time constant of a filter behind it [s].
    """

    stiffness: float = 1.0
    gap: float = 0.0
    friction: float = 0.0
    bristle: float = 2e-4
    viscous: float = 0.0
    tooth: tuple[float, float, float] = (0.0, 0.0, 1.0)
    ruler: tuple[float, float, float] = (0.0, 0.0, 1.0)
    scale: float = 1.0
    late: float = 0.0
    hardening: float = 0.0
    warming: float = 0.0
    crosstalk: float = 0.0
    rotor: float = 0.0
    filtered: float = 0.0
    damper: float = 0.0
    stale: float = 0.0
    drive_filter: float = 0.0


@dataclass(frozen=True)
class Recording:
    """What is hidden in a recording, and how it was taken.

    Attributes:
        gears: Of joints 1 to 3.
        noise: Of link encoder, motor encoder [rad] and torque [N m].
        dropped: Share of the samples that are missing.
        stated: Whether set.yaml states the noise.
        seconds: How long it is.
    """

    gears: tuple[Gear, Gear, Gear] = (Gear(), Gear(), Gear())
    noise: tuple[float, float, float] = (1.0e-5, 1.0e-6, 5.0)
    dropped: float = 0.0
    stated: bool = True
    seconds: float = 10.0

    def with_gear(self, joint: int, **changes: object) -> Recording:
        """The same with one joint (1 to 3) changed."""
        gears = list(self.gears)
        gears[joint - 1] = replace(gears[joint - 1], **changes)
        return replace(self, gears=tuple(gears))


def command(rng: np.random.Generator, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """A smooth path between random angles with rests at both ends: fine time (n,) and angle (n,)."""
    time = np.arange(int(seconds * RATE) * STEPS + 1) / (RATE * STEPS)
    angle = np.zeros_like(time)
    begin, here = rng.uniform(0.6, 1.2), 0.0
    while begin < seconds - 1.8:
        length = min(rng.uniform(1.2, 2.6), seconds - 0.6 - begin)
        goal = 0.0 if begin + length > seconds - 1.9 else rng.uniform(-0.8, 0.8)
        goal = here + np.clip(goal - here, -0.21 * length, 0.21 * length)
        s = np.clip((time - begin) / length, 0.0, 1.0)
        angle += (goal - here) * (10 * s**3 - 15 * s**4 + 6 * s**5)
        begin, here = begin + 0.8 * length, goal
    return time, angle


def swing(gear: Gear, joint: int, time: np.ndarray, motor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Integrate the link behind its gear: its angle (n,) [rad], and the torque the motor gives (n,) [N m]."""
    dt = float(time[1] - time[0])
    spring, inertia = STIFFNESS[joint] * gear.stiffness, INERTIA[joint]
    damper = 2.0 * DAMPING_RATIO * np.sqrt(spring * inertia) + gear.damper
    gravity, half = GRAVITY[joint], gear.gap / 2.0
    amplitude, phase, waves = gear.tooth
    driven = motor + amplitude * np.cos(waves * RATIO[joint] * motor + phase)
    speed = np.gradient(motor, dt)
    # A link's rate here is that of the step before; beside a strong damper half a step more looks like an inertia.
    pushed = np.diff(driven, prepend=driven[0]) / dt if gear.damper else np.gradient(driven, dt)
    load = gravity * math.cos(driven[0] - LEVEL)
    angle, rate = float(driven[0] - load / spring - half * np.sign(load)), 0.0
    bristle = 0.0
    found, torque = np.empty_like(time), np.empty_like(time)
    drives, pushes, moves = driven.tolist(), pushed.tolist(), np.diff(motor, prepend=motor[0]).tolist()
    for i in range(len(drives)):
        wound = drives[i] - angle
        free = wound - half if wound > half else (wound + half if wound < -half else 0.0)
        force = spring * free * (1.0 + gear.hardening * abs(spring * free) / 3000.0)
        touching = free != 0.0
        bend = damper * (pushes[i] - rate) if touching else 0.0
        bristle = min(max(bristle + moves[i] / gear.bristle, -1.0), 1.0)
        found[i] = angle
        torque[i] = force + bend + gear.friction * bristle + gear.viscous * speed[i]
        load = gravity * math.cos(angle - LEVEL) + BEARING * rate
        rate += dt * (force + bend - load) / inertia
        angle += dt * rate
    torque += gear.rotor * ROTOR[joint] * RATIO[joint] ** 2 * np.gradient(speed, dt)
    return found, torque


def behind_filter(values: np.ndarray, dt: float, constant: float) -> np.ndarray:
    """What a filter of first order with a time constant [s] makes of values, shape (n,)."""
    if constant == 0.0:
        return values
    found, now = np.empty_like(values), values[0]
    for i, value in enumerate(values.tolist()):
        now += (value - now) * -math.expm1(-dt / constant)
        found[i] = now
    return found


def record(folder: Path, hidden: Recording, seed: int) -> Path:
    """Write a motion set with the effects in it; returns its folder."""
    rng = np.random.default_rng([seed, 2025])
    count = int(hidden.seconds * RATE) + 1
    columns: dict[str, np.ndarray] = {}
    angles = []
    for joint in range(3):
        time, motor = command(rng, hidden.seconds)
        angles.append((time, motor, *swing(hidden.gears[joint], joint, time, motor)))
    columns["t"] = angles[0][0][::STEPS][:count]
    for joint, (_, motor, _, _) in enumerate(angles):
        columns[f"m{joint + 1}"] = motor[::STEPS] + rng.normal(0.0, hidden.noise[1], count)
    for joint, (time, _, link, _) in enumerate(angles):
        gear = hidden.gears[joint]
        amplitude, phase, waves = gear.ruler
        seen = gear.scale * link + amplitude * np.cos(waves * link + phase)
        seen = seen + gear.warming * time + gear.crosstalk * angles[(joint + 1) % 3][1]
        seen = behind_filter(seen, float(time[1] - time[0]), gear.filtered)
        read = np.interp(columns["t"] - gear.late, time, seen)
        columns[f"l{joint + 1}"] = read + rng.normal(0.0, hidden.noise[0], count) + rng.normal(0.0, 1e-3)
    for joint, (time, _, _, torque) in enumerate(angles):
        gear = hidden.gears[joint]
        felt = behind_filter(torque, float(time[1] - time[0]), gear.drive_filter)
        read = np.interp(columns["t"] - gear.stale, time, felt)
        columns[f"tau{joint + 1}"] = read + rng.normal(0.0, hidden.noise[2], count)
    for joint in range(6):
        columns[f"r{joint + 1}"] = angles[joint][1][::STEPS] if joint < 3 else np.zeros(count)
    kept = np.ones(count, dtype=bool)
    if hidden.dropped:
        kept[1:-1] = rng.uniform(size=count - 2) >= hidden.dropped
    folder.mkdir(parents=True, exist_ok=True)
    table = np.column_stack(list(columns.values()))[kept]
    np.savetxt(
        folder / "samples.csv", table, fmt="%.9g", delimiter=",", header=",".join(columns), comments=""
    )
    document = {
        "schema": "doormill/motion-set/1",
        "robot": "simulated",
        "source": "simulated gear train",
        "rate": RATE,
        "joints": [1, 2, 3],
        "model": {
            "gear_ratio": list(RATIO),
            "joint_stiffness": list(STIFFNESS),
            "motor_inertia": list(ROTOR),
        },
    }
    if hidden.stated:
        document["noise"] = dict(zip(("link", "motor", "torque"), hidden.noise, strict=True))
    (folder / "set.yaml").write_text(yaml.safe_dump(document, sort_keys=False))
    return folder


#: Effects that the library names: what is hidden, and how it changes a gear for a size of 1.
LIBRARY = (
    "time_skew",
    "joint_stiffness",
    "joint_backlash",
    "joint_friction",
    "joint_damping",
    "joint_periodic_error",
    "encoder_scale",
)
#: Effects that it does not name.
FOREIGN = ("hardening", "warming", "crosstalk")


def hide(
    rng: np.random.Generator, hidden: Recording, effect: str, joint: int, size: float
) -> tuple[Recording, tuple[str, str], float]:
    """Put one effect into a recording.

    Args:
        rng: Draws signs, orders and the like.
        hidden: What is in it already.
        effect: One of LIBRARY or FOREIGN, or "late clock" for all encoders together.
        joint: 1 to 3.
        size: In standard deviations of the link encoder, about, at the root mean square of a usual recording.

    Returns:
        The recording, name and place as a diagnosis has them, and the value of the main parameter.
    """
    rad = size * hidden.noise[0]
    spring = STIFFNESS[joint - 1] * hidden.gears[joint - 1].stiffness
    where = f"joint {joint}"
    if effect == "late clock":
        late = rad / 0.15
        for k in (1, 2, 3):
            hidden = hidden.with_gear(k, late=late)
        return hidden, ("time_skew", "link encoders"), late
    if effect == "time_skew":
        return hidden.with_gear(joint, late=rad / 0.15), (effect, where), rad / 0.15
    if effect == "joint_stiffness":
        swinging = (90.0, 1000.0, 800.0)[joint - 1]  # N m, root mean square of what the torque changes
        compliance = 1.0 / spring + rad / swinging
        return (
            hidden.with_gear(joint, stiffness=1.0 / compliance / STIFFNESS[joint - 1]),
            (effect, where),
            1.0 / compliance,
        )
    if effect == "joint_backlash":
        return hidden.with_gear(joint, gap=2.0 * rad), (effect, where), 2.0 * rad
    if effect == "joint_friction":
        return (
            hidden.with_gear(joint, friction=rad * spring, bristle=float(rng.choice([1e-4, 3e-4, 1e-3]))),
            (effect, where),
            rad * spring,
        )
    if effect == "joint_damping":
        return hidden.with_gear(joint, viscous=rad * spring / 0.15), (effect, where), rad * spring / 0.15
    if effect == "joint_periodic_error":
        kind = ("ruler", "tooth")[int(rng.integers(2))]
        waves = float(rng.choice([1.0, 2.0])) if kind == "tooth" else float(rng.uniform(200.0, 700.0))
        wave = (1.5 * rad, float(rng.uniform(0.0, 2.0 * np.pi)), waves)
        return hidden.with_gear(joint, **{kind: wave}), (effect, where), 1.5 * rad
    if effect == "encoder_scale":
        factor = 1.0 + float(rng.choice([-1.0, 1.0])) * rad / 0.2
        return hidden.with_gear(joint, scale=factor), (effect, where), factor
    changes = {
        "hardening": {"hardening": min(rad * spring / 300.0, 3.0)},
        "warming": {"warming": rad / 2.9},
        "crosstalk": {"crosstalk": rad / 0.2},
    }
    return hidden.with_gear(joint, **changes[effect]), (effect, where), rad
