"""A joint that first falls through a gap when its last motion went along the load."""

from __future__ import annotations

import numpy as np
from scipy.special import log_ndtr, ndtr

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import CauseParameter
from doormill_ros.robot_model.elastic.causes.cause import ALONE, DIRECTION, ElasticCause, index
from doormill_ros.robot_model.elastic.load_case import LoadCase

_GAP = 1e-4  #: theta 1 is a gap of this size [rad]
#: Starts of the crossing torque: the cost has a kink at every trial's torque, so they are spread.
_CROSSINGS = (0.0, 0.01, 0.03, 0.1, 0.3, 0.8)


class DisplacementBacklash(ElasticCause):
    """Theta is the gap over 1e-4 rad, and the crossing torque over the largest torque of the test.

    A joint that came from the other side lies against its flank (pre-loaded, section 3.3 of the
    thesis) and shows its spring alone. One that moved along the load shows the gap on top, all
    of it from the crossing torque on, in proportion to the torque below.
    """

    name = "joint_backlash"
    direct = ALONE
    driver = DIRECTION
    check = "mill a wall twice, reached from both sides"
    parameters = (CauseParameter("gap", "rad", 0.0, 2e-2), CauseParameter("crossing", "N m", 0.0, 1e3))
    scale = np.array([3.0, 0.3])
    lower = np.array([0.0, 0.0])
    upper = np.array([200.0, 1.0])
    kinked = (1,)

    def pattern(self) -> str:
        """What it leaves."""
        return (
            f"the residual of {self.where} is there only when its last motion went along the load, "
            "and then hardly grows with the torque"
        )

    def starts(self, case: LoadCase) -> list[FloatArray]:
        """Steps and ramps, of several sizes where last motions are unknown: there the gap picks the trials."""
        unknown = np.any(case.direction[:, index(self.where)] == 0.0)
        gaps = (0.1, 0.5, 3.0) if unknown else (1.0,)
        return [np.array([gap, crossing]) for crossing in _CROSSINGS for gap in gaps]

    def hidden_state(self, case: LoadCase) -> FloatArray | None:
        """Unknown direction, or a torque too small to tell its sign."""
        k = index(self.where)
        direction, torque = case.direction[:, k], case.torque[:, k]
        noise = np.maximum(case.torque_noise[:, k], 1e-12)
        along = np.where(direction == 0.0, 0.5, ndtr(direction * torque / noise))
        return np.where(along < 1e-6, 0.0, np.where(along > 1.0 - 1e-6, 1.0, along))

    def hidden_sign(self, case: LoadCase) -> FloatArray | None:
        """Neither last motion nor the sign of the torque known: the gap may have opened either way."""
        k = index(self.where)
        distance = np.abs(case.torque[:, k]) / np.maximum(case.torque_noise[:, k], 1e-12)
        unknown = (case.direction[:, k] == 0.0) & (distance < 5.0)
        return np.where(unknown, log_ndtr(distance) - log_ndtr(-distance), np.inf)

    def _ramp(self, case: LoadCase, theta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        k = index(self.where)
        direction, torque = case.direction[:, k], case.torque[:, k]
        # Near zero the size of a torque is mostly that of its noise.
        size = np.sqrt(np.maximum(torque**2 - case.torque_noise[:, k] ** 2, 0.0))
        share = size / case.largest_torque[k]
        full = share >= theta[1]
        ramp = np.where(full, 1.0, share / max(theta[1], 1e-12))
        slope = np.where(full, 0.0, -share / max(theta[1], 1e-12) ** 2)
        # The gap opens along the last motion; only where that is unknown does the load decide.
        sign = np.where(direction == 0.0, np.sign(torque), direction)
        return sign, ramp, slope

    def twist(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """With the gap open in every trial that may be open; the fit weighs by the hidden state."""
        sign, ramp, _ = self._ramp(case, theta)
        result: FloatArray = (_GAP * theta[0] * sign * ramp)[:, None] * case.joint_twist(index(self.where))
        return result

    def derivative(self, case: LoadCase, theta: FloatArray) -> FloatArray:
        """By gap and crossing."""
        sign, ramp, slope = self._ramp(case, theta)
        unit = _GAP * sign[:, None] * case.joint_twist(index(self.where))
        return np.stack([ramp[:, None] * unit, theta[0] * slope[:, None] * unit], axis=2)

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Gap [rad] and crossing torque [N m], shape (2,)."""
        return np.array([_GAP * theta[0], theta[1] * case.largest_torque[index(self.where)]])

    def from_values(self, values: FloatArray, case: LoadCase) -> FloatArray:
        """From gap [rad] and crossing torque [N m], shape (2,)."""
        return np.array([values[0] / _GAP, values[1] / case.largest_torque[index(self.where)]])
