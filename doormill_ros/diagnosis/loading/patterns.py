"""Shapes that no cause of the library leaves: if one of them fits best, something unknown is at work.

They are never named in a diagnosis. They compete with the causes so that a cause is not
blamed for an effect that merely resembles it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import Candidate
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, LinearTwist
from doormill_ros.robot_model.elastic.causes.joint_stiffness import JointStiffness
from doormill_ros.robot_model.elastic.law.memory import let_through
from doormill_ros.robot_model.elastic.law.parts import Motion, mount, shifted, torsion, yielding
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.elastic.places import JOINTS

#: What a pattern makes of joint k, 0 ... 5.
Law = Callable[[LoadCase, int], list[FloatArray]]
#: Least amplitude of a pattern that may have either sign.
_ANY = -1e6


class Pattern(LinearTwist):
    """A fixed pattern with free amplitudes of either sign."""

    named = False

    def __init__(
        self,
        name: str,
        where: str,
        size: int,
        unit: Callable[[LoadCase], FloatArray],
        lowest: float = _ANY,
        same_as: tuple[str, str] | tuple[()] = (),
    ) -> None:
        """Keep how to compute the pattern; `unit` gives shape (n, 6, size), `lowest` is the least amplitude."""
        super().__init__(where)
        self.name, self.same_as = name, same_as
        self._unit = unit
        self.scale, self.lower, self.upper = np.ones(size), np.full(size, lowest), np.full(size, 1e6)

    def pattern(self) -> str:
        """What it is."""
        return f"{self.name.replace('_', ' ')} of {self.where}"

    def unit(self, case: LoadCase) -> FloatArray:
        """The pattern."""
        return self._unit(case)

    def values(self, theta: FloatArray, case: LoadCase) -> FloatArray:
        """Amplitudes, shape (p,)."""
        return np.array(theta)


class VaryingSpring(Pattern):
    """A pattern that lets a spring vary; a constant cause beside it is only its mean value."""

    def spoils(self, other: Candidate[Any]) -> bool:
        """Where this one lets the same spring vary."""
        if self.where == other.where:
            return True
        everywhere = isinstance(other, ElasticCause) and other.scales_all
        return everywhere or (self.where == "cell" and other.where in JOINTS)


class _JointLaw(NamedTuple):
    """What may be in each joint: a pattern's name, how many numbers it has, its law, and what it is."""

    name: str
    size: int
    law: Law
    lowest: float = _ANY
    kind: type[Pattern] = VaryingSpring


# What patterns make at amplitude 1.
_TWIST = 1e-6  #: of a link under torsion [rad / (N m) a metre]
_YIELD = 1e-7  #: of bearings and base [m / N], [rad / (N m)]
_OFFSET = 1e-5  #: of a tracker [m]
_FORCE = 10.0  #: that a sensor reads without load [N]
#: Parts of a test in which what changes from its start on may settle: a pair spans what lies between.
_SETTLING = (0.03, 0.12)
#: Limits of a friction that remembers earlier loadings, over the largest torque of the test: likewise.
_REMEMBERING = (0.1, 0.4)
#: Limits up to which friction holds a spring, its elements' spread evenly, over the largest torque: one may stand near.
_STICKING = {"low": 0.15, "middle": 0.3, "high": 0.6}
_ELEMENTS = 4


def _joint(k: int, law: Law) -> Callable[[LoadCase], FloatArray]:
    """Angles of joint k, each shape (n,), as twists of the points."""

    def twists(case: LoadCase) -> FloatArray:
        return np.stack([angle[:, None] * case.joint_twist(k) for angle in law(case, k)], axis=2)

    return twists


def _springs(case: LoadCase, k: int) -> FloatArray:
    result: FloatArray = case.torque[:, k] / case.joint_stiffness[k]
    return result


def _share(case: LoadCase, k: int) -> FloatArray:
    result: FloatArray = np.abs(case.torque[:, k]) / max(case.largest_torque[k], 1e-9)
    return result


def _full(case: LoadCase, k: int) -> float:
    return float(max(case.largest_torque[k], 1e-9) / case.joint_stiffness[k])


def _along_axes(case: LoadCase, size: FloatArray) -> FloatArray:
    """A shift of all points along each axis, by multiples of `_OFFSET`, shape (n,)."""
    everywhere = np.ones(len(case), dtype=bool)
    return np.stack([shifted(_OFFSET * size[:, None] * axis, everywhere) for axis in np.eye(3)], axis=2)


def _over(values: FloatArray) -> FloatArray:
    """From -0.5 to 0.5 or so over their range, 0 in the mean, shape (n,); 0 where all are the same."""
    range_ = np.ptp(values)
    return np.zeros_like(values) if range_ == 0.0 else (values - values.mean()) / range_


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
    known = np.where(np.isfinite(temperature), temperature, np.nan)
    warm = np.zeros_like(time) if np.isnan(known).all() else np.nan_to_num(known - np.nanmean(known))
    late = _over(time)
    laws = _joint_laws(q, late, _early(time), _over(dt), warm)
    return [pattern for k in range(6) for pattern in _of_joint(k, laws)] + _of_all(late, warm)


def _early(time: FloatArray) -> list[FloatArray]:
    """What is still to come of changes that settle, from 1 on, shape (n,) each; 0 where all is of one time."""
    since, range_ = time - time.min(), np.ptp(time)
    return [np.zeros_like(time) if range_ == 0.0 else np.exp(-since / (part * range_)) for part in _SETTLING]


def _remembered(case: LoadCase, k: int) -> list[FloatArray]:
    """What friction lets through less for the loadings since the last motion, shape (n,) each; 0 for the first."""
    limits = [np.array([part * case.largest_torque[k]]) for part in _REMEMBERING]
    return [let_through(case, k, one, remembers=False) - let_through(case, k, one) for one in limits]


def _sticking(part: float) -> Law:
    """A spring behind friction elements of limits up to a part of the joint's largest torque."""
    spread = part * (np.arange(_ELEMENTS) + 0.5) / _ELEMENTS

    def law(case: LoadCase, k: int) -> list[FloatArray]:
        return [_springs(case, k) * let_through(case, k, spread * case.largest_torque[k])]

    return law


def _joint_laws(
    q: FloatArray, late: FloatArray, early: list[FloatArray], long: FloatArray, warm: FloatArray
) -> tuple[_JointLaw, ...]:
    """Those of a joint. One that stiffens with the torque has a name as a cause, one that softens none."""
    return (
        _JointLaw("joint_ripple", 2, lambda c, k: [f(q[:, k]) * _springs(c, k) for f in (np.sin, np.cos)]),
        _JointLaw(
            "joint_double_ripple",
            2,
            lambda c, k: [f(2 * q[:, k]) * _springs(c, k) for f in (np.sin, np.cos)],
        ),
        _JointLaw("joint_one_sided_spring", 1, lambda c, k: [np.abs(_springs(c, k))]),
        _JointLaw("joint_square_law", 1, lambda c, k: [_springs(c, k) * _share(c, k)], 0.0),
        _JointLaw("joint_cubic_law", 1, lambda c, k: [_springs(c, k) * _share(c, k) ** 2], 0.0),
        _JointLaw("joint_dead_zone", 1, lambda c, k: [np.sign(c.torque[:, k]) * _full(c, k)]),
        _JointLaw("joint_direction_shift", 1, lambda c, k: [c.direction[:, k] * _full(c, k)], kind=Pattern),
        _JointLaw("joint_ageing", 1, lambda c, k: [_springs(c, k) * late]),
        _JointLaw("joint_settling", 2, lambda c, k: [_springs(c, k) * part for part in early]),
        _JointLaw("joint_remembering", 2, lambda c, k: [_springs(c, k) * part for part in _remembered(c, k)]),
        *(_JointLaw(f"joint_sticking_{name}", 1, _sticking(part), 0.0) for name, part in _STICKING.items()),
        _JointLaw("joint_yielding", 1, lambda c, k: [_springs(c, k) * long]),
        _JointLaw("joint_creep", 1, lambda c, k: [late * _full(c, k)], kind=Pattern),
        _JointLaw("joint_warming", 1, lambda c, k: [_springs(c, k) * warm]),
    )


def _of_joint(k: int, laws: tuple[_JointLaw, ...]) -> list[Pattern]:
    """Those of one joint, of the link behind it and of its bearing."""
    where, link = f"joint {k + 1}", f"link {k + 1}"
    return [
        *(one.kind(one.name, where, one.size, _joint(k, one.law), one.lowest) for one in laws),
        Pattern("link_torsion", link, 1, _moved(torsion, link, _TWIST)),
        Pattern("bearing_shift", where, 1, _moved(yielding(-1), where, _YIELD)),
    ]


def _of_all(late: FloatArray, warm: FloatArray) -> list[Pattern]:
    """Those of base, tracker and sensor, and of all springs together."""
    return [
        Pattern("base_shift", "base", 1, _moved(yielding(0), "base", _YIELD)),
        # The upright axis of the base is that of joint 1.
        Pattern(
            "base_turn",
            "base",
            1,
            _moved(mount(0, (2,)), "base", _YIELD),
            same_as=(JointStiffness.name, JOINTS[0]),
        ),
        Pattern("constant_shift", "tracker", 3, lambda c: _along_axes(c, np.ones(len(c)))),
        Pattern("time_trend", "tracker", 3, lambda c: _along_axes(c, late)),
        Pattern("temperature_trend", "tracker", 3, lambda c: _along_axes(c, warm)),
        VaryingSpring("springs_warming", "cell", 1, lambda c: (warm[:, None] * c.springs())[:, :, None]),
        VaryingSpring("springs_ageing", "cell", 1, lambda c: (late[:, None] * c.springs())[:, :, None]),
        Pattern("load_bias", "sensor", 3, _bias),
        Pattern("step_in_time", "tracker", 3, lambda c: _along_axes(c, np.sign(late))),
    ]


def _moved(motion: Motion, where: str, size: float) -> Callable[[LoadCase], FloatArray]:
    """A motion of a part of the robot, of this size for amplitude 1."""

    def twists(case: LoadCase) -> FloatArray:
        return size * np.stack(motion(case, where), axis=2)

    return twists


def _bias(case: LoadCase) -> FloatArray:
    """A constant force in flange axes: what a badly zeroed sensor leaves."""
    twists = []
    for axis in np.moveaxis(case.axes[:, 6], 2, 0):
        arm = case.origin[:, 6][:, None] - case.origin[:, :6]
        torque = np.einsum("nki,nki->nk", case.axes[:, :6, :, 2], np.cross(arm, axis[:, None]))
        twist = np.zeros((len(case), 6))
        for k in range(6):
            twist += (_FORCE * torque[:, k] / case.joint_stiffness[k])[:, None] * case.joint_twist(k)
        twists.append(twist)
    return np.stack(twists, axis=2)
