"""Shapes that no cause of the library leaves: if one of them fits best, something unknown is at work.

They are never named in a diagnosis. They compete with the causes so that a cause is not
blamed for an effect that merely resembles it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Candidate
from doormill_ros.robot_model.elastic.causes.cause import LinearTwist
from doormill_ros.robot_model.elastic.load_case import LoadCase

#: Patterns that let a spring vary; a constant cause beside one of them is only its mean value.
_VARYING = ("ripple", "square_law", "cubic_law", "one_sided", "dead_zone", "ageing", "warming", "yielding")


class Pattern(LinearTwist):
    """A fixed pattern with free amplitudes of either sign."""

    named = False

    def __init__(
        self,
        name: str,
        where: str,
        size: int,
        unit: Callable[[LoadCase], FloatArray],
        lowest: float = -1e6,
    ) -> None:
        """Keep how to compute the pattern; `unit` gives shape (n, 6, size), `lowest` is the least amplitude."""
        super().__init__(where)
        self.name = name
        self._unit = unit
        self.scale, self.lower, self.upper = np.ones(size), np.full(size, lowest), np.full(size, 1e6)

    def pattern(self) -> str:
        """What it is."""
        return f"{self.name.replace('_', ' ')} of {self.where}"

    def spoils(self, other: Candidate[Any]) -> bool:
        """Where this one lets the same spring vary."""
        if not any(word in self.name for word in _VARYING):
            return False
        if self.where == other.where:
            return True
        everywhere = other.name in ("wrench_gain", "tracker_scale")
        return everywhere or (self.where == "cell" and other.name.startswith("joint_"))

    def unit(self, case: LoadCase) -> FloatArray:
        """The pattern."""
        return self._unit(case)

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Amplitudes."""
        return np.array(theta)


def _joint(k: int, law: Callable[[LoadCase], list[FloatArray]]) -> Callable[[LoadCase], FloatArray]:
    """Angles of joint k, each shape (n,), as twists of the points."""
    return lambda case: np.stack([a[:, None] * case.joint_twist(k) for a in law(case)], axis=2)


def _springs(case: LoadCase, k: int) -> FloatArray:
    return case.torque[:, k] / case.joint_stiffness[k]


def _share(case: LoadCase, k: int) -> FloatArray:
    return np.abs(case.torque[:, k]) / max(case.largest_torque[k], 1e-9)


def _full(case: LoadCase, k: int) -> float:
    return max(case.largest_torque[k], 1e-9) / case.joint_stiffness[k]


def _shift(vectors: list[FloatArray], case: LoadCase, first_link: int) -> FloatArray:
    twist = np.zeros((len(case), 6, len(vectors)))
    for i, vector in enumerate(vectors):
        twist[:, :3, i] = np.where(case.link[:, None] >= first_link, vector, 0.0)
    return twist


def unnamed_patterns(
    q: FloatArray, time: FloatArray, temperature: FloatArray, dt: FloatArray
) -> list[Pattern]:
    """All patterns for one test.

    Args:
        q: Commanded joint angles, shape (n, 6) [rad].
        time: Shape (n,) [s].
        temperature: Shape (n,) [deg C], NaN where unknown.
        dt: Time under load, shape (n,) [s].
    """
    late = np.zeros_like(time) if np.ptp(time) == 0.0 else (time - time.mean()) / np.ptp(time)
    long = np.zeros_like(dt) if np.ptp(dt) == 0.0 else (dt - dt.mean()) / np.ptp(dt)
    warm = np.where(np.isfinite(temperature), temperature, np.nan)
    warm = np.nan_to_num(warm - np.nanmean(warm)) if np.isfinite(warm).any() else np.zeros_like(time)
    found = []
    for k in range(6):
        where = f"joint {k + 1}"
        found += [
            Pattern(
                "joint_ripple",
                where,
                2,
                _joint(
                    k, lambda c, k=k: [np.sin(q[:, k]) * _springs(c, k), np.cos(q[:, k]) * _springs(c, k)]
                ),
            ),
            Pattern(
                "joint_double_ripple",
                where,
                2,
                _joint(
                    k,
                    lambda c, k=k: [
                        np.sin(2 * q[:, k]) * _springs(c, k),
                        np.cos(2 * q[:, k]) * _springs(c, k),
                    ],
                ),
            ),
            Pattern("joint_one_sided_spring", where, 1, _joint(k, lambda c, k=k: [np.abs(_springs(c, k))])),
            # A spring that stiffens with the torque has a name; one that softens has none.
            Pattern(
                "joint_square_law", where, 1, _joint(k, lambda c, k=k: [_springs(c, k) * _share(c, k)]), 0.0
            ),
            Pattern(
                "joint_cubic_law",
                where,
                1,
                _joint(k, lambda c, k=k: [_springs(c, k) * _share(c, k) ** 2]),
                0.0,
            ),
            Pattern(
                "joint_dead_zone", where, 1, _joint(k, lambda c, k=k: [np.sign(c.torque[:, k]) * _full(c, k)])
            ),
            Pattern(
                "joint_direction_shift", where, 1, _joint(k, lambda c, k=k: [c.direction[:, k] * _full(c, k)])
            ),
            Pattern("joint_ageing", where, 1, _joint(k, lambda c, k=k: [_springs(c, k) * late])),
            Pattern("joint_yielding", where, 1, _joint(k, lambda c, k=k: [_springs(c, k) * long])),
            Pattern("joint_creep", where, 1, _joint(k, lambda c, k=k: [late * _full(c, k)])),
            Pattern("joint_warming", where, 1, _joint(k, lambda c, k=k: [_springs(c, k) * warm])),
            Pattern("link_torsion", f"link {k + 1}", 1, lambda c, k=k: _torsion(c, k)),
            Pattern("bearing_shift", where, 1, lambda c, k=k: _shift([1e-7 * c.force], c, k + 1)),
        ]
    found += [
        Pattern("base_shift", "base", 1, lambda c: _shift([1e-7 * c.force], c, 0)),
        Pattern(
            "base_turn",
            "base",
            1,
            lambda c: c.rotate(1e-7 * c.moment[:, 0] * np.array([0.0, 0.0, 1.0]), 0, 0)[:, :, None],
        ),
        Pattern(
            "constant_shift",
            "tracker",
            3,
            lambda c: _shift([np.broadcast_to(1e-5 * e, (len(c), 3)) for e in np.eye(3)], c, 0),
        ),
        Pattern(
            "time_trend", "tracker", 3, lambda c: _shift([1e-5 * late[:, None] * e for e in np.eye(3)], c, 0)
        ),
        Pattern(
            "temperature_trend",
            "tracker",
            3,
            lambda c: _shift([1e-5 * warm[:, None] * e for e in np.eye(3)], c, 0),
        ),
        Pattern("springs_warming", "cell", 1, lambda c: (warm[:, None] * c.springs())[:, :, None]),
        Pattern("springs_ageing", "cell", 1, lambda c: (late[:, None] * c.springs())[:, :, None]),
        Pattern("load_bias", "sensor", 3, lambda c: _bias(c)),
        Pattern(
            "step_in_time",
            "tracker",
            3,
            lambda c: _shift([1e-5 * np.sign(late)[:, None] * e for e in np.eye(3)], c, 0),
        ),
    ]
    return found


def _torsion(case: LoadCase, k: int) -> FloatArray:
    line = case.origin[:, k + 1] - case.origin[:, k]
    length = np.linalg.norm(line, axis=1, keepdims=True)
    axis = line / np.where(length > 1e-9, length, 1.0)
    along = np.sum(case.moment[:, k + 1] * axis, axis=1, keepdims=True) * axis
    return case.rotate(1e-6 * length * along, k + 1, k + 1)[:, :, None]


def _bias(case: LoadCase) -> FloatArray:
    """A constant force in flange axes: what a badly zeroed sensor leaves."""
    twists = []
    for axis in np.moveaxis(case.axes[:, 6], 2, 0):
        load = case.point * 0.0
        arm = case.origin[:, 6][:, None] - case.origin[:, :6]
        torque = np.einsum("nki,nki->nk", case.axes[:, :6, :, 2], np.cross(arm, axis[:, None]))
        load = sum(
            (10.0 * torque[:, k] / case.joint_stiffness[k])[:, None] * case.joint_twist(k) for k in range(6)
        )
        twists.append(load)
    return np.stack(twists, axis=2)
