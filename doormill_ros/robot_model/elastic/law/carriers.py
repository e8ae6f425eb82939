"""What an effect acts on, as the motion of the measured point that one unit of it makes: one line a carrier.

A carrier times a shape of a driver is a term of a law: "spring of joint 2" times "logarithm of the time under load".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.robot_model.elastic.causes.link_bending import LinkBending
from doormill_ros.robot_model.elastic.load_case import LoadCase

#: Of loadings and where: twists for one unit, each shape (n, 6).
Motion = Callable[[LoadCase, str], list[FloatArray]]


@dataclass(frozen=True)
class Carrier:
    """Something that can be off.

    Attributes:
        motion: Twist of the measured point for one unit of each component.
        unit: Of an amplitude, SI; "1" for a share.
        size: A typical amplitude.
        does: What it does, in words, before the amount.
        of_robot: Whether it is in the robot and not in the measuring chain.
        components: How many motions there are.
    """

    motion: Motion
    unit: str
    size: float
    does: str
    of_robot: bool = True
    components: int = 1


def number_of(where: str) -> int:
    """Index 0 ... 5 of "joint 3" or "link 3"; -1 for a place without one."""
    kind, _, count = where.partition(" ")
    return int(count) - 1 if kind in ("joint", "link") else -1


def _along(vectors: FloatArray, moved: BoolArray) -> FloatArray:
    """A pure shift, shape (n, 6), of the points that move."""
    return np.concatenate([np.where(moved[:, None], vectors, 0.0), np.zeros_like(vectors)], axis=1)


def _spring(case: LoadCase, where: str) -> list[FloatArray]:
    k = number_of(where)
    return [(case.torque[:, k] / case.joint_stiffness[k])[:, None] * case.joint_twist(k)]


def _with_load(case: LoadCase, where: str) -> list[FloatArray]:
    k = number_of(where)
    return [np.sign(case.torque[:, k])[:, None] * case.joint_twist(k)]


def _tilt(case: LoadCase, where: str) -> list[FloatArray]:
    k = number_of(where)
    moment = case.moment[:, k] - case.torque[:, k, None] * case.axis(k)
    return [case.rotate(moment, k, k + 1)]


def _yielding(first: int) -> Motion:
    """A shift by the force from a link on; of joint k where the place is one."""

    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        link = number_of(where) + 1 if first < 0 else first
        return [_along(case.force, case.link >= link)]

    return motion


def _line(case: LoadCase, k: int) -> tuple[FloatArray, FloatArray]:
    line = case.origin[:, k + 1] - case.origin[:, k]
    length = np.linalg.norm(line, axis=1, keepdims=True)
    return line / np.where(length > 1e-9, length, 1.0), length


def _torsion(case: LoadCase, where: str) -> list[FloatArray]:
    k = number_of(where)
    axis, length = _line(case, k)
    moment = np.sum(case.moment[:, k + 1] * axis, axis=1, keepdims=True)
    return [case.rotate(length * moment * axis, k + 1, k + 1)]


def _bending(case: LoadCase, where: str) -> list[FloatArray]:
    return [LinkBending(where).unit(case)[:, :, 0] * 1e6]


def _across(case: LoadCase, k: int) -> tuple[FloatArray, FloatArray]:
    """Two axes fixed to link k + 1 across its line, shape (n, 3) each."""
    axis, _ = _line(case, k)
    own = case.axes[:, k + 1]
    aligned = np.abs(np.einsum("nij,ni->nj", own, axis)).mean(axis=0)
    first = np.cross(axis, own[:, :, int(np.argmin(np.round(aligned, 6)))])
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-9)
    return first, np.cross(axis, first)


def _at_middle(case: LoadCase, k: int, turn: FloatArray) -> FloatArray:
    """Everything beyond the middle of link k + 1 turns about it; points on the link itself stay."""
    middle = 0.5 * (case.origin[:, k] + case.origin[:, k + 1])
    twist = np.concatenate([np.cross(turn, case.point - middle), turn], axis=1)
    twist[case.link < k + 1] = 0.0
    return twist


def _hinge(case: LoadCase, where: str) -> list[FloatArray]:
    """By the moment at the middle of the link: about two axes across it, and about one by the other's."""
    k = number_of(where)
    axes = _across(case, k)
    lever = 0.5 * (case.origin[:, k] + case.origin[:, k + 1]) - case.origin[:, k + 1]
    moment = case.moment[:, k + 1] + np.cross(-lever, case.force)
    one, two = (np.sum(moment * axis, axis=1, keepdims=True) for axis in axes)
    turns = (one * axes[0], two * axes[1], one * axes[1] + two * axes[0])
    return [_at_middle(case, k, turn) for turn in turns]


def _crooked(case: LoadCase, where: str) -> list[FloatArray]:
    k = number_of(where)
    return [_at_middle(case, k, axis) for axis in _across(case, k)]


def _longer(case: LoadCase, where: str) -> list[FloatArray]:
    k = number_of(where)
    return [_along(_line(case, k)[0], case.link > k)]


def _seat(case: LoadCase, where: str) -> list[FloatArray]:
    """The tool turns on the flange about its axes, whatever the load."""
    return [case.rotate(axis, 6, 6) for axis in np.moveaxis(case.axes[:, 6], 2, 0)]


def _mount(frame: int, axes: tuple[int, ...]) -> Motion:
    """Everything from a frame on turns about some of its axes by the moment about them."""

    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        turn = np.zeros((len(case), 3))
        for axis in np.moveaxis(case.axes[:, frame], 2, 0)[list(axes)]:
            turn = turn + np.sum(case.moment[:, frame] * axis, axis=1, keepdims=True) * axis
        return [case.rotate(turn, frame, frame)]

    return motion


def _wrench(case: LoadCase, force: FloatArray, couple: FloatArray) -> FloatArray:
    """Twist by the springs of a wrench that the sensor did not read; shapes (n, 3) [N, N m]."""
    arm = case.load[:, None] - case.origin[:, :6]
    axes = case.axes[:, :6, :, 2]
    torque = np.einsum("nki,nki->nk", axes, np.cross(arm, force[:, None]) + couple[:, None])
    give = torque / case.joint_stiffness
    return sum((give[:, k, None] * case.joint_twist(k) for k in range(6)), np.zeros((len(case), 6)))


def _read(case: LoadCase) -> FloatArray:
    """What the sensor reads, sensor axes, shape (n, 6) [N, N m]."""
    couple = case.moment[:, 6] - np.cross(case.load - case.origin[:, 6], case.force)
    parts = [np.einsum("nji,nj->ni", case.sensor, vector) for vector in (case.force, couple)]
    return np.concatenate(parts, axis=1)


def _channel(case: LoadCase, channel: int, amount: FloatArray) -> FloatArray:
    vector = case.sensor[:, :, channel % 3] * amount[:, None]
    none = np.zeros_like(vector)
    return _wrench(case, vector, none) if channel < 3 else _wrench(case, none, vector)


def _bias(channels: tuple[int, ...]) -> Motion:
    return lambda case, where: [_channel(case, c, np.ones(len(case))) for c in channels]


def _crosstalk(of: int, into: int) -> Motion:
    return lambda case, where: [_channel(case, into, _read(case)[:, of])]


def _gain(case: LoadCase, where: str) -> list[FloatArray]:
    return [case.springs()]


def _shift(case: LoadCase, where: str) -> list[FloatArray]:
    every = np.ones(len(case), dtype=bool)
    return [_along(np.broadcast_to(axis, (len(case), 3)), every) for axis in np.eye(3)]


def _turned(case: LoadCase, where: str) -> list[FloatArray]:
    """What a tracker that has turned makes of a displacement."""
    every = np.ones(len(case), dtype=bool)
    return [_along(np.cross(axis, case.springs()[:, :3]), every) for axis in np.eye(3)]


def _turning(case: LoadCase, where: str) -> list[FloatArray]:
    """What a tracker that turns between two readings makes of a place; it shifts too, for nobody knows its place."""
    every = np.ones(len(case), dtype=bool)
    return [*(_along(np.cross(axis, case.point), every) for axis in np.eye(3)), *_shift(case, where)]


def _lasting(case: LoadCase) -> FloatArray:
    """Time between the two readings, shape (n, 1) [s]; none where nobody read."""
    dt = case.circumstances.dt
    return np.zeros((len(case), 1)) if dt is None else np.asarray(dt, dtype=float)[:, None]


def _drifting(motion: Motion) -> Motion:
    """A motion at a speed: it goes on while a trial lasts."""
    return lambda case, where: [twist * _lasting(case) for twist in motion(case, where)]


def _skew(of: int, into: int) -> Motion:
    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        vectors = np.zeros((len(case), 3))
        vectors[:, into] = case.springs()[:, of]
        return [_along(vectors, np.ones(len(case), dtype=bool))]

    return motion


def _is(case: LoadCase, where: str) -> BoolArray:
    names = case.circumstances.reflector
    if names is None:
        return np.zeros(len(case), dtype=bool)
    return np.asarray(names == where.partition(" ")[2], dtype=bool)


def _slip(case: LoadCase, where: str) -> list[FloatArray]:
    axes = case.axes[np.arange(len(case)), case.link]
    return [_along(axes[:, :, i], _is(case, where)) for i in range(3)]


def _swing(case: LoadCase, where: str) -> list[FloatArray]:
    return [_along(case.springs()[:, :3], _is(case, where))]


def _drawn(case: LoadCase, where: str) -> list[FloatArray]:
    """Along the force, whatever its size."""
    size = np.maximum(np.linalg.norm(case.force, axis=1, keepdims=True), 1e-9)
    return [_along(case.force / size, _is(case, where))]


_XYZ = "xyz"
_CHANNELS = ("fx", "fy", "fz", "mx", "my", "mz")

#: Carriers by what they act on, as in diagnosis.json.
CARRIERS: dict[str, Carrier] = {
    "spring": Carrier(_spring, "1", 0.1, "gives way more"),
    "joint angle": Carrier(lambda case, where: [case.joint_twist(number_of(where))], "rad", 1e-5, "turns"),
    "joint angle with the load": Carrier(_with_load, "rad", 1e-5, "turns with the load"),
    "tilt across the axis": Carrier(_tilt, "rad / (N m)", 1e-7, "tilts across its axis"),
    "bearing": Carrier(_yielding(-1), "m / N", 1e-7, "yields to the force"),
    "torsion": Carrier(_torsion, "rad / (N m^2)", 1e-7, "twists about its length"),
    "bending": Carrier(_bending, "1 / (N m^2)", 1e-7, "bends"),
    "hinge": Carrier(_hinge, "rad / (N m)", 1e-7, "gives way at its middle", True, 3),
    "straightness": Carrier(_crooked, "rad", 1e-5, "bends at its middle, whatever the load,", True, 2),
    "length": Carrier(_longer, "m", 1e-5, "grows"),
    "seat": Carrier(_seat, "rad", 1e-5, "turns about x, y, z of the flange, whatever the load,", True, 3),
    "base tilt": Carrier(_mount(0, (0, 1)), "rad / (N m)", 1e-8, "tilts"),
    "base turn": Carrier(_mount(0, (2,)), "rad / (N m)", 1e-8, "turns about its upright axis"),
    "base shift": Carrier(_yielding(0), "m / N", 1e-7, "yields to the force"),
    "tool tilt": Carrier(_mount(6, (0, 1)), "rad / (N m)", 1e-6, "tilts"),
    "tool turn": Carrier(_mount(6, (2,)), "rad / (N m)", 1e-6, "turns about the axis of the flange"),
    "tool shift": Carrier(_yielding(6), "m / N", 1e-7, "yields to the force"),
    "force bias": Carrier(_bias((0, 1, 2)), "N", 5.0, "reads a force too small", False, 3),
    "torque bias": Carrier(_bias((3, 4, 5)), "N m", 5.0, "reads a torque too small", False, 3),
    "sensor gain": Carrier(_gain, "1", 0.05, "reads too small a share", False),
    **{
        f"crosstalk {_CHANNELS[of]} into {_CHANNELS[into]}": Carrier(
            _crosstalk(of, into),
            "1" if of // 3 == into // 3 else ("m" if into >= 3 else "1 / m"),
            {(0, 0): 0.05, (1, 1): 0.05, (0, 1): 0.02, (1, 0): 0.1}[of // 3, into // 3],
            f"reads too little {_CHANNELS[into]} by a share of {_CHANNELS[of]}",
            False,
        )
        for of in range(6)
        for into in range(6)
    },
    "reading": Carrier(_shift, "m", 1e-5, "reads along x, y, z", False, 3),
    "axes": Carrier(_turned, "rad", 0.01, "stands turned about x, y, z", False, 3),
    "place": Carrier(_turning, "rad, m", 1e-5, "turns about and moves along x, y, z", False, 6),
    "drift": Carrier(_drifting(_shift), "m / s", 1e-7, "drifts along x, y, z", False, 3),
    "turning": Carrier(_drifting(_turning), "rad / s, m / s", 1e-7, "turns and drifts", False, 6),
    **{
        f"axes {_XYZ[of]} into {_XYZ[into]}": Carrier(
            _skew(of, into), "1", 0.05, f"adds to {_XYZ[into]} a share of {_XYZ[of]}", False
        )
        for of in range(3)
        for into in range(3)
    },
    "slip": Carrier(_slip, "m", 1e-5, "slips along x, y, z of its link", False, 3),
    "slip along the load": Carrier(_drawn, "m", 1e-5, "slips along the force", False),
    "holder": Carrier(_swing, "1", 0.1, "moves more than its link", False),
}
