"""A link that bends like a straight beam between its two joints."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import WRENCH, LinearTwist, index
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.elastic.places import LINKS

_SCALE = 1e-6  #: theta 1 is an EI of a million N m^2


class LinkBending(LinearTwist):
    """1 / EI is fitted; the link is clamped at its joint and loaded at its far end (Euler-Bernoulli).

    The line of the beam runs from the origin of frame k-1 to that of frame k. Displacement of the
    far end F L^3 / 3 EI + M L^2 / 2 EI, rotation F L^2 / 2 EI + M L / EI, across the line only.
    """

    name = "link_bending"
    places = LINKS
    direct = "put reflectors on both ends of the link"
    driver = WRENCH
    parameters = (CauseParameter("EI", "N m^2", 1e3, 1e9),)
    scale = np.array([1.0])
    lower = np.array([0.0])
    upper = np.array([1000.0])

    def pattern(self) -> str:
        """What it leaves."""
        return f"everything from the far end of {self.where} on sinks and tilts with the load across the link"

    def unit(self, case: LoadCase) -> FloatArray:
        """Motion of the far end, carried to the points."""
        k = index(self.where)
        line = case.origin[:, k + 1] - case.origin[:, k]
        length = np.linalg.norm(line, axis=1, keepdims=True)
        axis = line / np.where(length > 1e-9, length, 1.0)
        force = case.force - np.sum(case.force * axis, axis=1, keepdims=True) * axis
        moment = case.moment[:, k + 1]
        moment = moment - np.sum(moment * axis, axis=1, keepdims=True) * axis
        rotation = length**2 / 2.0 * cross(axis, force) + length * moment
        shift = length**3 / 3.0 * force + length**2 / 2.0 * cross(moment, axis)
        twist = case.rotate(_SCALE * rotation, k + 1, k + 1)
        twist[:, :3] += np.where(case.link[:, None] > k, _SCALE * shift, 0.0)
        return twist[:, :, None]

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """EI [N m^2], shape (1,)."""
        return 1.0 / (_SCALE * np.maximum(theta, 1e-12))

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From EI [N m^2], shape (1,)."""
        return 1.0 / (_SCALE * np.asarray(values))
