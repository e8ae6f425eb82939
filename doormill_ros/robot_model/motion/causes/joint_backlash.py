"""Play in a gear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import TORQUE, MotionCause
from doormill_ros.robot_model.motion.view import SeenMotion

#: Torques at which the teeth lie firmly on one side [N m].
CROSSINGS = (10.0, 50.0, 200.0)
#: Halves of gaps that a motor crosses while friction holds the link [rad].
HELD = (2e-5, 5e-5, 1e-4, 2e-4, 5e-4)
_LARGEST = 0.01  #: rad


class JointBacklash(MotionCause):
    """x is the gap [rad]: the link lies on the side that the torque presses it to, or stays where friction holds it."""

    name = "joint_backlash"
    follows = TORQUE

    def __init__(self, where: str, law: str = "pressed", size: float = CROSSINGS[0]) -> None:
        """Put it at its place.

        Args:
            where: Place.
            law: "pressed" by the torque, with `size` the torque that presses firmly [N m], or "held" by friction, with
                `size` half of the way that the motor goes [rad].
            size: See above.
        """
        super().__init__(where)
        self.law, self.size = law, size

    @classmethod
    def candidates(cls, where: str, motions: Sequence[SeenMotion]) -> Sequence[MotionCause]:
        """Both laws; the first only where the torque changes its sign."""
        turns = any(float(seen.torque.min()) < 0.0 < float(seen.torque.max()) for seen in motions)
        pressed = [cls(where, "pressed", crossing) for crossing in CROSSINGS] if turns else []
        return [*pressed, *(cls(where, "held", half) for half in HELD)]

    @property
    def settings(self) -> dict[str, Any]:
        """The law and its size."""
        return {"law": self.law, "size": self.size}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any]) -> Self:
        """With its law."""
        return cls(where, str(settings["law"]), float(settings["size"]))

    def columns(self, seen: SeenMotion) -> FloatArray:
        """Half the gap against the side on which the motor pushes, shape (n, 1)."""
        if self.law == "pressed":
            return -0.5 * np.clip(seen.torque / self.size, -1.0, 1.0)[:, None]
        return -0.5 * seen.slip(self.size, 0.0)[:, None]

    def own_columns(self, seen: SeenMotion) -> FloatArray:
        """Where in the gap a held link lay when the recording began, shape (n, 1 or 0)."""
        if self.law == "pressed":
            return np.zeros((len(seen), 0))
        return -0.25 * (seen.slip(self.size, 1.0) - seen.slip(self.size, -1.0))[:, None]

    def allowed(self, x: FloatArray, stiffness: float, motions: Sequence[SeenMotion]) -> bool:
        """A size that gaps have; a held link is left by just the way that the motor goes."""
        gap = float(x[0])
        fits = self.law == "pressed" or 0.4 < gap / (2.0 * self.size) < 2.5
        return 0.0 < gap < _LARGEST and fits

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """The gap."""
        return {"gap": (float(x[0]), "rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return "the difference of the encoders jumps by the gap where the torque changes its sign"
