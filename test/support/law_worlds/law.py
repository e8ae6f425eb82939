"""A hidden law: where it sits, what drives it, and what it does to a session."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from support.law_worlds.geometry import Hinge, cracked_link, joint
from support.law_worlds.session import Session

#: What the contract lets a driver be; "joint k" with its number.
DRIVERS = (
    "own angle",
    "angle of joint k",
    "own torque",
    "torque of joint k",
    "direction",
    "torque sign",
    "time",
    "time under load",
    "temperature",
    "speed",
    "wrench",
    "constant",
    "path",
)


@dataclass(frozen=True, eq=False)
class Effect:
    """What a law does in every row.

    Attributes:
        turns: Hinges and the angles by which they turn beyond what the simulation says, shape (n,) [rad].
        reading: Error of the force sensor, sensor axes, shape (n, 6) [N, N m].
        apparent: Displacement without any hinge, base frame, shape (n, 3) [m].
    """

    turns: tuple[tuple[Hinge, np.ndarray], ...] = ()
    reading: np.ndarray | float = 0.0
    apparent: np.ndarray | float = 0.0

    def scaled(self, size: float) -> Effect:
        """`size` times as large."""
        turns = tuple((hinge, size * angle) for hinge, angle in self.turns)
        return Effect(turns, size * self.reading, size * self.apparent)


@dataclass(frozen=True, eq=False)
class Law:
    """A law of unit size.

    Attributes:
        name, form: Which law, and which of its forms where it has several.
        where: joint k, link k, tool, base, sensor, tracker, or reflector with its name.
        driver: One of DRIVERS, with the joint's number.
        also: Drivers that are as true, or that the columns cannot tell from it.
        effect: Of any session, so that loads can be changed and the law kept.
        largest: Size that physics allows: a spring that varies stays a spring.
        parameters: Numbers of the law at unit size.
        hinge: The joint that obeys it, if it is one.
        around_mean: Whether the stated spring already holds the law's mean slope.
    """

    name: str
    where: str
    driver: str
    effect: Callable[[Session], Effect]
    largest: float
    parameters: dict[str, Any]
    also: tuple[str, ...] = ()
    form: str = ""
    hinge: Hinge | None = field(default=None, repr=False)
    around_mean: bool = False


def of_hinge(
    name: str,
    hinge: Hinge,
    driver: str,
    felt: Callable[[Session, np.ndarray], np.ndarray],
    largest: float,
    **more: Any,
) -> Law:
    """A law that makes one hinge turn by its compliance times `felt(session, own torque)`, (n,) [N m]."""

    def effect(session: Session) -> Effect:
        return Effect(((hinge, hinge.compliance * felt(session, session.torque(hinge))),))

    parameters = {"unit_compliance": hinge.compliance, **more.pop("parameters", {})}
    obeys = hinge if hinge.where.startswith("joint") else None
    return Law(name, hinge.where, driver, effect, largest, parameters, hinge=obeys, **more)


def around_its_mean(law: Law, hinge: Hinge, session: Session) -> Law:
    """The law of a joint whose stated spring was identified in this session, so that its mean slope is in it."""
    torque, (_, angle) = session.torque(hinge), law.effect(session).turns[0]
    rows = session.seen
    slope = float(angle[rows] @ torque[rows] / (torque[rows] @ torque[rows]))

    def effect(other: Session) -> Effect:
        (_, whole), *_ = law.effect(other).turns
        return Effect(((hinge, whole - slope * other.torque(hinge)),))

    # The stated spring less the mean must still be one.
    largest = min(law.largest, 0.8 * hinge.compliance / slope) if slope > 0.0 else law.largest
    parameters = {**law.parameters, "mean_compliance": slope}
    return replace(law, effect=effect, largest=largest, parameters=parameters, around_mean=True)


def any_joint(rng: np.random.Generator) -> Hinge:
    """One of the six."""
    return joint(int(rng.integers(1, 7)))


def joint_or_link(rng: np.random.Generator) -> Hinge:
    """A joint, or in one of four a long link."""
    if rng.random() < 0.75:
        return any_joint(rng)
    return cracked_link(int(rng.choice([2, 4])), float(rng.uniform(-0.9, 0.9)))
