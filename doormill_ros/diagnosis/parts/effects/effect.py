"""What every effect in milled doors has to say about itself."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.course import BEGINS, CHANGES, DRIFTS, SizedEffect
from doormill_ros.diagnosis.parts.effects.case import CutCase

_FAR = 1e6


class Effect(SizedEffect[CutCase]):
    """One way in which milled doors can differ from what was assumed, of a size theta that a `SizeCourse` lets change.

    It moves points along their normals in proportion to theta, or it changes what the joints carry: the process wrench
    or the weight.

    Attributes:
        of_force: Whether theta is what is added to the factor on the wrench (first) and to its angle [rad] (second).
        of_weight: Whether it adds torques in proportion to theta, see `torques`.
        courses: Ways in which its size may go over the doors beside staying what it is.
        rigid: Whether it displaces the tool or the door as a whole, whatever the process is.
    """

    of_force = False
    of_weight = False
    courses: tuple[str, ...] = (BEGINS, CHANGES, DRIFTS)
    rigid = False

    @property
    def of_load(self) -> bool:
        """Whether it changes what the joints carry."""
        return self.of_force or self.of_weight

    def columns(self, case: CutCase) -> FloatArray:
        """Points along their normals for theta = 1, shape (n, p) [m]."""
        raise NotImplementedError

    def wrench(self, case: CutCase, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Factor on the wrench and its turn about the tool [rad], shape (n,) each, for thetas of shape (n, p)."""
        raise NotImplementedError

    def torques(self, case: CutCase) -> FloatArray:
        """What joints carry beside the process for theta = 1, shape (n, 6, p) [N m]."""
        raise NotImplementedError

    def limit(self, scale: FloatArray | list[float], lower: float = -_FAR, upper: float = _FAR) -> None:
        """Set typical size and bounds of theta, shape (p,)."""
        self.scale = np.array(scale, dtype=float)
        self.lower, self.upper = np.full(len(self.scale), lower), np.full(len(self.scale), upper)


class Unloaded(Effect):
    """Moves points whatever the joints carry."""

    def columns(self, case: CutCase) -> FloatArray:
        """Computed once for the same points under whatever loads."""
        if self.identity not in case.unloaded:
            case.unloaded[self.identity] = self.displacement(case)
        return case.unloaded[self.identity]

    def displacement(self, case: CutCase) -> FloatArray:
        """Points along their normals for theta = 1, shape (n, p) [m]; asks nothing of the loads."""
        raise NotImplementedError
