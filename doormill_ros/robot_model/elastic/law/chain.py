"""What sensor, tracker and reflectors make of a motion, for one unit of what is off; shapes (n, 6) each."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import cross
from doormill_ros.robot_model.elastic.law.parts import Motion, shifted
from doormill_ros.robot_model.elastic.load_case import LoadCase


def _wrench(case: LoadCase, force: FloatArray, couple: FloatArray) -> FloatArray:
    """Twist by the springs of a wrench that the sensor did not read; shapes (n, 3) [N, N m]."""
    arm = case.load[:, None] - case.origin[:, :6]
    axes = case.axes[:, :6, :, 2]
    torque = np.einsum("nki,nki->nk", axes, cross(arm, force[:, None]) + couple[:, None])
    give = torque / case.joint_stiffness
    return sum((give[:, k, None] * case.joint_twist(k) for k in range(6)), np.zeros((len(case), 6)))


def _read(case: LoadCase) -> FloatArray:
    """What the sensor reads, sensor axes, shape (n, 6) [N, N m]."""
    couple = case.moment[:, 6] - cross(case.load - case.origin[:, 6], case.force)
    parts = [np.einsum("nji,nj->ni", case.sensor, vector) for vector in (case.force, couple)]
    return np.concatenate(parts, axis=1)


def _channel(case: LoadCase, channel: int, amount: FloatArray) -> FloatArray:
    vector = case.sensor[:, :, channel % 3] * amount[:, None]
    none = np.zeros_like(vector)
    return _wrench(case, vector, none) if channel < 3 else _wrench(case, none, vector)


def bias(channels: tuple[int, ...]) -> Motion:
    """What one unit in each of some channels (fx fy fz mx my mz) makes."""
    return lambda case, where: [_channel(case, c, np.ones(len(case))) for c in channels]


def crosstalk(of: int, into: int) -> Motion:
    """What a share of one channel in another makes."""
    return lambda case, where: [_channel(case, into, _read(case)[:, of])]


def gain(case: LoadCase, where: str) -> list[FloatArray]:
    """What a share of the whole wrench makes; shape (n, 6) each."""
    return [case.springs()]


def shift(case: LoadCase, where: str) -> list[FloatArray]:
    """Along each axis of the base; shape (n, 6) each."""
    every = np.ones(len(case), dtype=bool)
    return [shifted(np.broadcast_to(axis, (len(case), 3)), every) for axis in np.eye(3)]


def turned(case: LoadCase, where: str) -> list[FloatArray]:
    """What a tracker that has turned makes of a displacement; shape (n, 6) each."""
    every = np.ones(len(case), dtype=bool)
    return [shifted(cross(axis, case.springs()[:, :3]), every) for axis in np.eye(3)]


def turning(case: LoadCase, where: str) -> list[FloatArray]:
    """A tracker that turns between two readings, and shifts, as its place is unknown; shape (n, 6) each."""
    every = np.ones(len(case), dtype=bool)
    return [*(shifted(cross(axis, case.point), every) for axis in np.eye(3)), *shift(case, where)]


def _lasting(case: LoadCase) -> FloatArray:
    """Time between the two readings, shape (n, 1) [s]; none where nobody read."""
    dt = case.circumstances.dt
    return np.zeros((len(case), 1)) if dt is None else np.asarray(dt, dtype=float)[:, None]


def drifting(motion: Motion) -> Motion:
    """A motion at a speed: it goes on while a trial lasts."""
    return lambda case, where: [twist * _lasting(case) for twist in motion(case, where)]


def skew(of: int, into: int) -> Motion:
    """A share of one coordinate in another."""

    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        vectors = np.zeros((len(case), 3))
        vectors[:, into] = case.springs()[:, of]
        return [shifted(vectors, np.ones(len(case), dtype=bool))]

    return motion


def _is(case: LoadCase, where: str) -> BoolArray:
    names = case.circumstances.reflector
    if names is None:
        return np.zeros(len(case), dtype=bool)
    return np.asarray(names == where.partition(" ")[2], dtype=bool)


def slip(case: LoadCase, where: str) -> list[FloatArray]:
    """Along each axis of the link, of one reflector; shape (n, 6) each."""
    axes = case.axes[np.arange(len(case)), case.link]
    return [shifted(axes[:, :, i], _is(case, where)) for i in range(3)]


def swing(case: LoadCase, where: str) -> list[FloatArray]:
    """A share of its own displacement, of one reflector; shape (n, 6) each."""
    return [shifted(case.springs()[:, :3], _is(case, where))]


def drawn(case: LoadCase, where: str) -> list[FloatArray]:
    """Along the force, whatever its size; shape (n, 6) each."""
    size = np.maximum(np.linalg.norm(case.force, axis=1, keepdims=True), 1e-9)
    return [shifted(case.force / size, _is(case, where))]
