"""What every cause of a wrong model has to say about itself, whatever kind of data questions the model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from doormill_ros.arrays import FloatArray

#: What a candidate looks at to know how it acts: loads and geometry, or localisations.
Case = TypeVar("Case")


@dataclass(frozen=True)
class CauseParameter:
    """One reported number (or vector) of a cause.

    Attributes:
        name: Key in the diagnosis.
        unit: SI unit.
        low, high: Plausible range of each component.
        size: Number of components.
    """

    name: str
    unit: str
    low: float
    high: float
    size: int = 1


class Cause:
    """One way in which reality can differ from a model, with its place.

    Attributes:
        name: Fixed name.
        where: Place.
        of_robot: Whether it is in the robot; one in the measuring chain changes nothing for who mills with it.
        variant: Tells apart two readings of the same cause.
        named: Whether a diagnosis may name it; patterns that only warn of the unknown are not.
        acts_in: Part of the cell, where its place does not say so by itself.
        check: What shows it without more data of the same kind, as an order; empty where nothing is known to.
    """

    name: str = ""
    where: str = ""
    of_robot: bool = True
    variant: str = ""
    named: bool = True
    acts_in: str = ""
    check: str = ""

    def __init__(self, where: str) -> None:
        """Put the cause at its place."""
        self.where = where

    def __repr__(self) -> str:
        return f"{self.name} at {self.where}" + (f" ({self.variant})" if self.variant else "")

    @property
    def key(self) -> tuple[str, str]:
        """Name and place."""
        return self.name, self.where

    @property
    def identity(self) -> tuple[str, str, str]:
        """Name, place and variant."""
        return self.name, self.where, self.variant

    def pattern(self) -> str:
        """One sentence: what it leaves in the data."""
        raise NotImplementedError


class Candidate(Cause, Generic[Case]):
    """A cause that a search over sets of causes can try.

    Numbers that are fitted ("theta") are scaled so that the effect is near linear in them and zero means no effect.

    Attributes:
        parameters: What is reported.
        scale: Size of a typical effect in theta, shape (p,).
        lower, upper: Allowed theta, shape (p,).
        generalises: Name of the candidate at the same place that this one contains as a special case.
        kinked: Indices of theta in which the cost is not smooth; their uncertainty is profiled.
        series: Of candidates that are one but for a number which is tried at some values instead of fitted: what they
            have in common. Empty for all others.
        same_as: Name and place of a cause that does the same whatever the posture and load, unless something is
            measured between the two; only words tell them apart. Empty for all others.
    """

    parameters: tuple[CauseParameter, ...] = ()
    scale: FloatArray
    lower: FloatArray
    upper: FloatArray
    generalises: str = ""
    kinked: tuple[int, ...] = ()
    series: str = ""
    same_as: tuple[str, str] | tuple[()] = ()

    @property
    def size(self) -> int:
        """Number of fitted numbers."""
        return len(self.scale)

    def starts(self, case: Case) -> list[FloatArray]:
        """Values of theta from which a fit may start, each of shape (p,)."""
        return [np.zeros(self.size)]

    def kinks(self, case: Case) -> FloatArray:
        """Values of a kinked number at which the cost may have a kink, shape (n,)."""
        raise NotImplementedError

    def spoils(self, other: Candidate[Any]) -> bool:
        """Whether another one in the same model is unbelievable beside this one: both shape the same thing."""
        return False

    def values(self, theta: FloatArray, case: Case) -> FloatArray:
        """Reported values of all parameters in a row, shape (v,)."""
        raise NotImplementedError


def number(where: str) -> int:
    """Number of 'joint 3' or 'link 3', counted from 1 as it is spoken."""
    return int(where.split()[1])
