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
        """Amplitudes, shape (p,)."""
        return np.array(theta)


#: Least amplitude of a pattern that may have either sign.
_ANY = -1e6
_TWIST = 1e-6  #: of a link under torsion at theta 1 [rad / (N m) a metre]
#: What a pattern makes of joint k, 0 ... 5.
Law = Callable[[LoadCase, int], list[FloatArray]]


def _joint(k: int, law: Law) -> Callable[[LoadCase], FloatArray]:
    """Angles of joint k, each shape (n,), as twists of the points."""

    def twists(case: LoadCase) -> FloatArray:
        return np.stack([angle[:, None] * case.joint_twist(k) for angle in law(case, k)], axis=2)

    return twists


def _at(k: int, unit: Callable[[LoadCase, int], FloatArray]) -> Callable[[LoadCase], FloatArray]:
    return lambda case: unit(case, k)


def _springs(case: LoadCase, k: int) -> FloatArray:
    result: FloatArray = case.torque[:, k] / case.joint_stiffness[k]
    return result


def _share(case: LoadCase, k: int) -> FloatArray:
    result: FloatArray = np.abs(case.torque[:, k]) / max(case.largest_torque[k], 1e-9)
    return result


def _full(case: LoadCase, k: int) -> float:
    return float(max(case.largest_torque[k], 1e-9) / case.joint_stiffness[k])


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
    # Name, numbers, law and least amplitude; a spring that stiffens with the torque has a name, one that softens none.
    laws: tuple[tuple[str, int, Law, float], ...] = (
        ("joint_ripple", 2, lambda c, k: [f(q[:, k]) * _springs(c, k) for f in (np.sin, np.cos)], _ANY),
        (
            "joint_double_ripple",
            2,
            lambda c, k: [f(2 * q[:, k]) * _springs(c, k) for f in (np.sin, np.cos)],
            _ANY,
        ),
        ("joint_one_sided_spring", 1, lambda c, k: [np.abs(_springs(c, k))], _ANY),
        ("joint_square_law", 1, lambda c, k: [_springs(c, k) * _share(c, k)], 0.0),
        ("joint_cubic_law", 1, lambda c, k: [_springs(c, k) * _share(c, k) ** 2], 0.0),
        ("joint_dead_zone", 1, lambda c, k: [np.sign(c.torque[:, k]) * _full(c, k)], _ANY),
        ("joint_direction_shift", 1, lambda c, k: [c.direction[:, k] * _full(c, k)], _ANY),
        ("joint_ageing", 1, lambda c, k: [_springs(c, k) * late], _ANY),
        ("joint_yielding", 1, lambda c, k: [_springs(c, k) * long], _ANY),
        ("joint_creep", 1, lambda c, k: [late * _full(c, k)], _ANY),
        ("joint_warming", 1, lambda c, k: [_springs(c, k) * warm], _ANY),
    )
    found = []
    for k in range(6):
        where = f"joint {k + 1}"
        found += [Pattern(name, where, size, _joint(k, law), lowest) for name, size, law, lowest in laws]
        found += [
            Pattern("link_torsion", f"link {k + 1}", 1, _at(k, _torsion)),
            Pattern("bearing_shift", where, 1, _at(k, lambda c, k: _shift([1e-7 * c.force], c, k + 1))),
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
    return case.rotate(_TWIST * length * along, k + 1, k + 1)[:, :, None]


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
