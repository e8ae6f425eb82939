"""What every cause of a difference between the two encoders of a gear has to say about itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Cause
from doormill_ros.robot_model.motion.view import SeenMotion

#: What causes act on in the words of laws, as these begin, and what drives them.
SPRING, FRICTION, DELAY = "spring", "friction", "delay"
TORQUE, SPEED = ("own torque", "torque sign"), ("speed",)


class MotionCause(Cause):
    """One way in which link minus motor angle can differ from minus torque over stiffness.

    It is linear in its coefficients x; what is not linear (a width, an order) is a setting of the candidate. Effects
    that depend on how a joint came to rest before the recording have columns of their own, sized for each recording.

    Attributes:
        phased: Whether the recording's own columns are a wave of which it owns the phase, not the height.
        acts_on: What it acts on in the words of laws, as these begin; empty where none says the same.
        follows: Drivers of which it is one law: where something else follows one of them too, the law is another.
        of_delay: Whether its coefficient is what is missing of the delay at which a model sees the joint.
        of_spring: Whether its coefficient is compliance of the spring beyond the model's.
        told_settings: Settings that are told beside its parameters.
    """

    phased: bool = False
    acts_on: str = ""
    follows: tuple[str, ...] = ()
    of_delay: bool = False
    of_spring: bool = False
    told_settings: tuple[str, ...] = ()

    @property
    def slow(self) -> bool:
        """Whether it is so slow a wave that a few of them can stand for whatever is slow."""
        return False

    @classmethod
    def candidates(cls, where: str, motions: Sequence[SeenMotion]) -> Sequence[MotionCause]:
        """Every variant that could act in a joint of some recordings."""
        return [cls(where)]

    @property
    def settings(self) -> dict[str, Any]:
        """What a model's file has to state besides the place."""
        return {}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any]) -> Self:
        """The cause of a model's file; KeyError where a setting is missing."""
        return cls(where)

    @property
    def slot(self) -> tuple[str, ...]:
        """Candidates that share a slot are readings of one thing: a model holds one of them."""
        return (self.name, self.where)

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Link minus motor angle for a unit of every coefficient, shape (n, k)."""
        raise NotImplementedError

    def own_columns(self, seen: SeenMotion) -> FloatArray:
        """The same for coefficients that belong to the recording, shape (n, j)."""
        return np.zeros((len(seen), 0))

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """Whether coefficients, shape (k,), are plausible beside a spring of the joint [N m / rad]."""
        return True

    def nearer(self, x: FloatArray, stiffness: float) -> Self:
        """The same in the shape that fits coefficients, shape (k,); itself where there is nothing nearer."""
        return self

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Reported parameters with their units.

        Args:
            x: Coefficients, shape (k,).
            stiffness: Of the joint in the model that holds the cause [N m / rad].
        """
        raise NotImplementedError

    def pattern(self) -> str:
        """One sentence: what the cause leaves in the data."""
        raise NotImplementedError


def largest_torque(motions: Sequence[SeenMotion]) -> float:
    """Largest torque of some recordings [N m]."""
    return max(float(np.max(np.abs(seen.torque))) for seen in motions)
