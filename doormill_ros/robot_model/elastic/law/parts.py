"""How parts of the robot move the measured point, for one unit of what is off; shapes (n, 6) each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import cross
from doormill_ros.robot_model.elastic.causes.link_bending import LinkBending
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.law.parts import number_of

#: Of loadings and where: twists for one unit, each shape (n, 6).
Motion = Callable[[LoadCase, str], list[FloatArray]]


def shifted(vectors: FloatArray, moved: BoolArray) -> FloatArray:
    """A pure shift, shape (n, 6), of the points that move."""
    return np.concatenate([np.where(moved[:, None], vectors, 0.0), np.zeros_like(vectors)], axis=1)


def spring(case: LoadCase, where: str) -> list[FloatArray]:
    """By the torque over the stiffness of the model; shape (n, 6) each."""
    k = number_of(where)
    return [(case.torque[:, k] / case.joint_stiffness[k])[:, None] * case.joint_twist(k)]


def with_load(case: LoadCase, where: str) -> list[FloatArray]:
    """One radian the way the load turns it; shape (n, 6) each."""
    k = number_of(where)
    return [np.sign(case.torque[:, k])[:, None] * case.joint_twist(k)]


def coupling(other: int) -> Motion:
    """The torque of another joint turns this one, and by Maxwell's theorem of reciprocity the other way round."""

    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        k = number_of(where)
        this, that = (case.torque[:, i, None] * case.joint_twist(j) for i, j in ((other, k), (k, other)))
        return [this + that]

    return motion


def tilt(case: LoadCase, where: str) -> list[FloatArray]:
    """By the moment across the axis, about the origin of the joint; shape (n, 6) each."""
    k = number_of(where)
    moment = case.moment[:, k] - case.torque[:, k, None] * case.axis(k)
    return [case.rotate(moment, k, k + 1)]


def yielding(first: int) -> Motion:
    """A shift by the force from a link on; of joint k where the place is one."""

    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        link = number_of(where) + 1 if first < 0 else first
        return [shifted(case.force, case.link >= link)]

    return motion


def _line(case: LoadCase, k: int) -> tuple[FloatArray, FloatArray]:
    line = case.origin[:, k + 1] - case.origin[:, k]
    length = np.linalg.norm(line, axis=1, keepdims=True)
    return line / np.where(length > 1e-9, length, 1.0), length


def torsion(case: LoadCase, where: str) -> list[FloatArray]:
    """By the moment along the link, about its line; shape (n, 6) each."""
    k = number_of(where)
    axis, length = _line(case, k)
    moment = np.sum(case.moment[:, k + 1] * axis, axis=1, keepdims=True)
    return [case.rotate(length * moment * axis, k + 1, k + 1)]


def bending(case: LoadCase, where: str) -> list[FloatArray]:
    """As an Euler-Bernoulli beam; shape (n, 6) each."""
    beam, one = LinkBending(where), np.ones(1)
    return [beam.twist(case, one) * beam.values(one, case)]


def across(case: LoadCase, k: int) -> tuple[FloatArray, FloatArray]:
    """Two axes fixed to link k + 1 across its line, shape (n, 3) each."""
    axis, _ = _line(case, k)
    own = case.axes[:, k + 1]
    aligned = np.abs(np.einsum("nij,ni->nj", own, axis)).mean(axis=0)
    first = cross(axis, own[:, :, int(np.argmin(np.round(aligned, 6)))])
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-9)
    return first, cross(axis, first)


def at_middle(case: LoadCase, k: int, turn: FloatArray) -> FloatArray:
    """Everything beyond the middle of link k + 1 turns about it, turn (n, 3) to twist (n, 6); the link itself stays."""
    middle = 0.5 * (case.origin[:, k] + case.origin[:, k + 1])
    twist = np.concatenate([cross(turn, case.point - middle), turn], axis=1)
    twist[case.link < k + 1] = 0.0
    return twist


def moment_at_middle(case: LoadCase, k: int) -> FloatArray:
    """Moment of the load about the middle of link k + 1, shape (n, 3) [N m]."""
    lever = 0.5 * (case.origin[:, k] + case.origin[:, k + 1]) - case.origin[:, k + 1]
    return case.moment[:, k + 1] + cross(-lever, case.force)


def hinge(case: LoadCase, where: str) -> list[FloatArray]:
    """By the moment at the middle of the link, about two axes across it and between them; shape (n, 6) each."""
    k = number_of(where)
    axes = across(case, k)
    moment = moment_at_middle(case, k)
    one, two = (np.sum(moment * axis, axis=1, keepdims=True) for axis in axes)
    turns = (one * axes[0], two * axes[1], one * axes[1] + two * axes[0])
    return [at_middle(case, k, turn) for turn in turns]


def crooked(case: LoadCase, where: str) -> list[FloatArray]:
    """A kink at the middle of the link about either axis across it; shape (n, 6) each."""
    k = number_of(where)
    return [at_middle(case, k, axis) for axis in across(case, k)]


def longer(case: LoadCase, where: str) -> list[FloatArray]:
    """Along the line of the link; shape (n, 6) each."""
    k = number_of(where)
    return [shifted(_line(case, k)[0], case.link > k)]


def seat(case: LoadCase, where: str) -> list[FloatArray]:
    """The tool turns on the flange about its axes, whatever the load; shape (n, 6) each."""
    return [case.rotate(axis, 6, 6) for axis in np.moveaxis(case.axes[:, 6], 2, 0)]


def mount(frame: int, axes: tuple[int, ...]) -> Motion:
    """Everything from a frame on turns about some of its axes by the moment about them."""

    def motion(case: LoadCase, where: str) -> list[FloatArray]:
        turn = np.zeros((len(case), 3))
        for axis in np.moveaxis(case.axes[:, frame], 2, 0)[list(axes)]:
            turn = turn + np.sum(case.moment[:, frame] * axis, axis=1, keepdims=True) * axis
        return [case.rotate(turn, frame, frame)]

    return motion
