"""What base and tool have in common: a mount that tilts about two of its axes."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import LinearTwist
from doormill_ros.robot_model.elastic.load_case import LoadCase


class TiltingMount(LinearTwist):
    """Tilts by moment over rotational stiffness about x and y of one frame; 1 / stiffness is fitted.

    The plain variant has one stiffness for both axes, the variant "two axes" one for each.
    """

    parameters = (CauseParameter("stiffness", "N m / rad", 1e3, 1e9),)
    variants = ("", "two axes")
    frame: int
    first_link: int
    unit_compliance: float  #: theta 1 [rad / (N m)]

    def __init__(self, where: str, variant: str = "") -> None:
        """Choose one stiffness or two."""
        super().__init__(where)
        self.variant = variant
        size = 2 if variant else 1
        self.scale, self.lower, self.upper = np.ones(size), np.zeros(size), np.full(size, 1000.0)
        if variant:
            self.parameters = (CauseParameter("stiffness", "N m / rad", 1e3, 1e9, 2),)
            self.generalises = self.name

    @classmethod
    def build(cls, where: str, variant: str) -> TiltingMount:
        """With one stiffness or two."""
        return cls(where, variant)

    def unit(self, case: LoadCase) -> FloatArray:
        """Tilt about x and about y, apart or together."""
        tilts = []
        for axis in (case.axes[:, self.frame, :, 0], case.axes[:, self.frame, :, 1]):
            moment = np.sum(case.moment[:, self.frame] * axis, axis=1, keepdims=True)
            tilts.append(case.rotate(self.unit_compliance * moment * axis, self.frame, self.first_link))
        if self.variant:
            return np.stack(tilts, axis=2)
        return (tilts[0] + tilts[1])[:, :, None]

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Rotational stiffness [N m / rad], shape (1,), (2,) about two axes."""
        return 1.0 / (self.unit_compliance * np.maximum(theta, 1e-9))

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From the stiffness [N m / rad], shape (1,)."""
        return 1.0 / (self.unit_compliance * np.asarray(values, dtype=float))
