"""What every cause of a difference between the two encoders of a gear has to say about itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Cause
from doormill_ros.robot_model.motion.view import SeenMotion


class MotionCause(Cause):
    """One way in which link minus motor angle can differ from minus torque over stiffness.

    It is linear in its coefficients x; what is not linear (a width, an order) is a setting of the candidate. Effects
    that depend on how a joint came to rest before the recording have columns of their own, sized for each recording.

    Attributes:
        phased: Whether the recording's own columns are a wave of which it owns the phase, not the height.
    """

    phased: bool = False

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
