"""Friction within a joint that remembers: what of a load reaches its spring, after the way and the loadings before.

A gear that gives way by a spring which friction holds until its limit is a Prandtl element; some of them beside each
other, of limits spread evenly, are a joint of Iwan, whose loops widen with the load. Such an element lies against the
side that the joint came from, each loading moves it, and unloading leaves it where the friction holds it, until the
joint moves again: Ruderman, Hoffmann and Bertram, Modeling and identification of elastic robot joints with hysteresis
and backlash, 2009; Iwan, A distributed-element model for hysteresis, 1966.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.robot_model.elastic.load_case import LoadCase

#: Elements that stand for limits spread evenly.
_SPREAD = 8
#: Limits a decade, as preferred numbers (ISO 3, R20): those that are tried first are every fourth.
_DECADE = (
    1.0,
    1.12,
    1.25,
    1.4,
    1.6,
    1.8,
    2.0,
    2.24,
    2.5,
    2.8,
    3.15,
    3.55,
    4.0,
    4.5,
    5.0,
    5.6,
    6.3,
    7.1,
    8.0,
    9.0,
)
_LIMITS = tuple(float(f"{number * 10.0**power:.3g}") for power in range(-1, 4) for number in _DECADE)
_ROUGH = 4
#: Limits that are tried, over the largest torque of the joint in the test.
_LEAST, _MOST = 0.02, 1.0
#: Angles by which a joint has moved between two loadings [rad].
_MOVED = 1e-5


@dataclass(frozen=True)
class Friction:
    """Friction before a spring.

    Attributes:
        limit: Torque that it holds after a motion against the load, at most [N m].
        spread: Whether many elements share the spring, of limits spread evenly up to this one.
    """

    limit: float
    spread: bool

    @property
    def driver(self) -> str:
        """What drives a spring behind it."""
        limit = f"{'up to' if self.spread else 'of'} {self.limit:g} N m"
        return f"path (share of the load that friction {limit} lets through)"

    def share(self, case: LoadCase, joint: int) -> FloatArray:
        """Part of the torque of a joint (0 ... 5) that it lets through in each loading, shape (n,)."""
        parts = (np.arange(_SPREAD) + 0.5) / _SPREAD if self.spread else np.ones(1)
        return let_through(case, joint, self.limit * parts)

    def beside(self) -> list[Friction]:
        """Those of the limits next to its own, and of the other kind."""
        at = _LIMITS.index(self.limit)
        near = [_LIMITS[i] for i in range(at - 2, at + 3) if i != at and 0 <= i < len(_LIMITS)]
        return [*(Friction(limit, self.spread) for limit in near), Friction(self.limit, not self.spread)]


#: All of them by what they drive.
FRICTIONS = {one.driver: one for spread in (False, True) for one in (Friction(x, spread) for x in _LIMITS)}


def tried(case: LoadCase, joint: int) -> list[Friction]:
    """Those that loadings of a joint (0 ... 5) may tell."""
    share = np.array(_LIMITS[::_ROUGH]) / case.largest_torque[joint]
    limits = [limit for limit, part in zip(_LIMITS[::_ROUGH], share, strict=True) if _LEAST <= part <= _MOST]
    return [Friction(limit, spread) for spread in (False, True) for limit in limits]


def let_through(case: LoadCase, joint: int, limits: FloatArray, remembers: bool = True) -> FloatArray:
    """Part of the torque of a joint that friction elements let through, shape (n,), their mean.

    The play operator of each element starts at its end after a known last motion, in the middle after an unknown one.

    Args:
        case: The loadings.
        joint: 0 ... 5.
        limits: Of the elements, shape (m,) [N m].
        remembers: Whether a loading finds them as the ones before it left them; else each comes after a motion.
    """
    torque, half = case.torque[:, joint], 0.5 * np.asarray(limits, dtype=float)
    rest = -np.sign(case.direction[:, joint, None]) * half
    result = np.zeros(len(case))
    for rows, before in _in_turn(case) if remembers else [(np.arange(len(case)), None)]:
        if before is not None:
            # What came before is taken off in full: then every element moves back as far as its friction lets it.
            rest[rows] = np.clip(_loaded(rest[before], torque[before], half), -half, half)
        moved = (_loaded(rest[rows], torque[rows], half) - rest[rows]).mean(axis=1)
        result[rows] = np.where(
            torque[rows] == 0.0, 0.0, moved / np.where(torque[rows] == 0.0, 1.0, torque[rows])
        )
    return result


def _loaded(rest: FloatArray, torque: FloatArray, half: FloatArray) -> FloatArray:
    """States of elements (n, m) under torques (n,), from where they were [N m]."""
    result: FloatArray = np.clip(rest, torque[:, None] - half, torque[:, None] + half)
    return result


def _in_turn(case: LoadCase) -> Sequence[tuple[IntArray, IntArray | None]]:
    """First loadings after a motion, then the second ones, and so on, each with the loadings just before them.

    Nothing is recorded between two loadings: where angles and last motions stayed, the joints did. A row whose unloaded
    reading was taken before the loaded one of the row before is of the same loading. Where no time is known, every
    loading comes after a motion.
    """
    n, time, lasted = len(case), case.circumstances.time, case.circumstances.dt
    if time is None or np.ptp(time) == 0.0:
        return [(np.arange(n), None)]
    begun = time if lasted is None else time - np.nan_to_num(lasted)
    order = np.argsort(time, kind="stable")
    where = np.column_stack([case.q, case.direction])[order]
    moved = np.any(np.abs(np.diff(where, axis=0)) > _MOVED, axis=1)
    later = begun[order][1:] > time[order][:-1]
    number, before = np.zeros(n, dtype=int), np.arange(n)
    for i in range(1, n):
        if moved[i - 1]:
            continue
        this, last = order[i], order[i - 1]
        number[this] = number[last] + later[i - 1]
        before[this] = last if later[i - 1] else before[last]
    turns: list[tuple[IntArray, IntArray | None]] = [(np.flatnonzero(number == 0), None)]
    for count in range(1, int(number.max()) + 1):
        rows = np.flatnonzero(number == count)
        turns.append((rows, before[rows]))
    return turns
