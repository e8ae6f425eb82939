"""Springs of joints and links that depend on something, without memory."""

from __future__ import annotations

import numpy as np

from support.law_worlds.geometry import joint, tool_seat
from support.law_worlds.law import Law, any_joint, joint_or_link, of_hinge
from support.law_worlds.session import Session

#: Share of the stated compliance by which one that varies about it may vary, and by which one may grow.
VARIES, GROWS = 0.6, 3.0


def one_sided_spring(rng: np.random.Generator, session: Session) -> Law:
    """Softer where the load turns it one way."""
    side = float(rng.choice([-1.0, 1.0]))
    return of_hinge(
        "one_sided_spring",
        joint_or_link(rng),
        "torque sign",
        lambda _, torque: np.where(side * torque > 0.0, torque, 0.0),
        GROWS,
        also=("own torque",),
        parameters={"side": side},
    )


def gear_waves(rng: np.random.Generator, session: Session) -> Law:
    """Compliance with 2 to 30 waves a turn of the joint."""
    hinge = any_joint(rng)
    waves, phase = int(rng.integers(2, 31)), float(rng.uniform(0.0, 2 * np.pi))
    return of_hinge(
        "gear_waves",
        hinge,
        "own angle",
        lambda s, torque: torque * np.sin(waves * s.q[:, hinge.link - 1] + phase),
        VARIES,
        parameters={"waves": waves, "phase": phase},
    )


def worn_sector(rng: np.random.Generator, session: Session) -> Law:
    """Teeth worn where the gear worked most: softer about one angle."""
    hinge = any_joint(rng)
    angles = session.q[session.seen, hinge.link - 1]
    # Where several postures stand, else nobody could see it.
    middle, width = float(np.quantile(angles, rng.uniform(0.3, 0.7))), float(rng.uniform(0.25, 0.5))
    return of_hinge(
        "worn_sector",
        hinge,
        "own angle",
        lambda s, torque: torque * np.exp(-(((s.q[:, hinge.link - 1] - middle) / width) ** 2)),
        GROWS,
        parameters={"middle": middle, "width": width},
    )


def neighbour_angle(rng: np.random.Generator, session: Session) -> Law:
    """A spring that depends on where another joint stands."""
    hinge = any_joint(rng)
    other = int(rng.choice([j for j in range(1, 7) if j != hinge.link]))
    waves, phase = int(rng.integers(1, 3)), float(rng.uniform(0.0, 2 * np.pi))
    return of_hinge(
        "neighbour_angle",
        hinge,
        f"angle of joint {other}",
        lambda s, torque: torque * np.sin(waves * s.q[:, other - 1] + phase),
        VARIES,
        parameters={"waves": waves, "phase": phase},
    )


def coupling(rng: np.random.Generator, session: Session) -> Law:
    """The torque about one joint turns another."""
    hinge = any_joint(rng)
    other = int(rng.choice([j for j in range(1, 7) if j != hinge.link]))
    return of_hinge(
        "coupling",
        hinge,
        f"torque of joint {other}",
        lambda s, torque: s.torque(joint(other)),
        GROWS,
    )


def creep(rng: np.random.Generator, session: Session) -> Law:
    """Gives on under a load that stays, exponentially (Kelvin-Voigt) or with the logarithm of time."""
    form = str(rng.choice(["logarithmic", "exponential"]))
    constant = float(rng.uniform(10.0, 30.0) if form == "exponential" else rng.uniform(2.0, 20.0))

    def grown(dt: np.ndarray) -> np.ndarray:
        if form == "exponential":
            return 1.0 - np.exp(-dt / constant)
        return np.log1p(dt / constant) / np.log1p(200.0 / constant)

    return of_hinge(
        "creep",
        joint_or_link(rng),
        "time under load",
        lambda s, torque: torque * grown(s.dt),
        GROWS,
        form=form,
        parameters={"time_constant": constant},
    )


def warming(rng: np.random.Generator, session: Session) -> Law:
    """Softer as the robot warms from its start, or with the air of the room."""
    form = str(rng.choice(["start", "room"]))
    constant, mean = float(rng.uniform(2e3, 9e3)), 21.0

    def warm(s: Session) -> np.ndarray:
        if form == "start":
            return 1.0 - np.exp(-s.t / constant)
        return (s.air - mean) / 3.0

    return of_hinge(
        "warming",
        joint_or_link(rng),
        "time" if form == "start" else "temperature",
        lambda s, torque: torque * warm(s),
        GROWS if form == "start" else VARIES,
        form=form,
        parameters={"time_constant": constant} if form == "start" else {"mean": mean, "per": 3.0},
    )


def direction_spring(rng: np.random.Generator, session: Session) -> Law:
    """Stiffer after one direction of motion than after the other, whatever the load's sign."""
    hinge = any_joint(rng)
    return of_hinge(
        "direction_spring",
        hinge,
        "direction",
        lambda s, torque: torque * s.approach[:, hinge.link - 1],
        VARIES,
    )


def opening_seat(rng: np.random.Generator, session: Session) -> Law:
    """Bolted faces that open beyond a moment: a gear's output, both ways, or the tool's seat, one way."""
    at_tool = bool(rng.random() < 0.5)
    hinge = tool_seat(float(rng.uniform(-np.pi, np.pi))) if at_tool else any_joint(rng)
    holds = float(rng.uniform(0.3, 1.0) * np.median(np.abs(session.torque(hinge))))

    def beyond(_: Session, torque: np.ndarray) -> np.ndarray:
        open_ = np.maximum(torque - holds, 0.0)
        return open_ if at_tool else open_ - np.maximum(-torque - holds, 0.0)

    return of_hinge(
        "opening_seat",
        hinge,
        "wrench" if at_tool else "own torque",
        beyond,
        GROWS,
        also=("own torque",) if at_tool else (),
        form="tool" if at_tool else "joint",
        parameters={"holds": holds},
    )
