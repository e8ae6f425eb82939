"""The way of the tool that milled a door: what the robot did along it, and its stretches through the features."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.parts.doors.late import aside
from doormill_ros.diagnosis.parts.doors.recorded_cut import RecordedCut
from doormill_ros.frames import apply, inverse
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.load_case import build_load_case

#: Samples of the executed path are divided by this: between two of them, half a millimetre apart, a cutter of 19 mm
#: reaches 3 um less far than along the way.
FINER = 4
STILL = 1e-7  #: two places of the tool nearer than this are one [m]
NEIGHBOURS = 2e-3  #: samples farther apart do not tell how the way bends [m]


@dataclass(frozen=True, eq=False)
class Moving:
    """What a moment of a run owes to those before it, for m samples.

    Attributes:
        direction: Last motion of each joint, shape (m, 6).
        late: How far beside the way the tool passes that follows late, base axes, shape (m, lags, 3) [m].
        feed: Speed at which a sample was reached, shape (m,) [m / s].
    """

    direction: FloatArray
    late: FloatArray
    feed: FloatArray

    @classmethod
    def along(cls, cut: RecordedCut) -> Self:
        """Of all samples of a run."""
        tip = cut.tool[:, :3, 3]
        way, lasting = np.linalg.norm(np.diff(tip, axis=0), axis=1), np.diff(cut.time)
        feed = np.divide(way, lasting, out=np.zeros(len(way)), where=lasting > 0.0)
        return cls(last_motions(cut.q), aside(cut.time, tip), np.concatenate([feed[:1], feed]))


@dataclass(frozen=True, eq=False)
class Way:
    """The way of the tool through one feature, finely; feature axes where `flat`.

    Attributes:
        flat: Tip, shape (m, 3) [m].
        axis: Of the spindle, out of the wood to into it, shape (m, 3).
        moved: How far the springs move the tip under the assumed load, shape (m, 3) [m].
        bend: Its curvature, shape (m, 3) [1 / m].
        late: How far beside it a tool passes that follows late, shape (m, lags, 3) [m].
        feed: Speed of the tool, shape (m,) [m / s].
        q, direction, wrench: As in `CutPoints`, shape (m, 6).
    """

    flat: FloatArray
    axis: FloatArray
    moved: FloatArray
    bend: FloatArray
    late: FloatArray
    feed: FloatArray
    q: FloatArray
    direction: FloatArray
    wrench: FloatArray


def last_motions(q: FloatArray) -> FloatArray:
    """Direction in which each joint last moved, -1, 0 before it ever did, 1; shape (m, 6) for angles (m, 6)."""
    step = np.diff(q, axis=0)
    sign = np.where(np.abs(step) > 1e-9, np.sign(step), 0.0)
    direction = np.zeros_like(q)
    for i in range(1, len(q)):
        direction[i] = np.where(sign[i - 1] == 0.0, direction[i - 1], sign[i - 1])
    return direction


def curvature(points: FloatArray) -> FloatArray:
    """Curvature of a way towards its centre, shape (m, 3) [1 / m]: of the circle through each point and its neighbours.

    Args:
        points: Shape (m, 3) [m]; of several at one place each has the curvature of that place.
    """
    kept = np.concatenate([[True], np.linalg.norm(np.diff(points, axis=0), axis=1) > STILL])
    knots = points[kept]
    bend = np.zeros_like(knots)
    if len(knots) > 2:
        step = np.diff(knots, axis=0)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        turn = np.diff(step / length, axis=0)
        near = np.maximum(length[1:], length[:-1]) < NEIGHBOURS  # beside a gap nobody knows the way
        bend[1:-1] = np.where(near, 2.0 * turn / (length[1:] + length[:-1]), 0.0)
    found: FloatArray = bend[np.cumsum(kept) - 1]
    return found


def way_through(
    cut: RecordedCut,
    moving: Moving,
    cutting: BoolArray,
    T_base_feature: FloatArray,
    robot: Robot,
    T_flange_tool: FloatArray,
) -> Way:
    """The stretches of a run through one feature.

    Args:
        cut: The run.
        moving: Of all its samples.
        cutting: Samples in the wood of that feature, shape (m,); one at least.
        T_base_feature: Where the feature was milled, shape (4, 4).
        robot: That milled it.
        T_flange_tool: Its tool, shape (4, 4).
    """
    rows = np.flatnonzero(cutting)
    case = build_load_case(
        Kinematics(robot),
        cut.q[rows],
        cut.wrench[rows],
        T_flange_tool[:3, 3],
        joint_stiffness=np.array(robot.stiffness),
    )
    follows = np.append(np.diff(rows) == 1, False)  # on a piece of way, that does not lead from pass to pass
    before = np.repeat(np.arange(len(rows)), np.where(follows, FINER, 1))
    share = (np.arange(len(before)) - np.searchsorted(before, before))[:, None] / FINER
    behind = before + follows[before]
    R_feature_base = T_base_feature[:3, :3].T

    def finely(values: FloatArray) -> FloatArray:
        found: FloatArray = values[before] * (1.0 - share) + values[behind] * share
        return found

    return Way(
        flat=finely(apply(inverse(T_base_feature), cut.tool[rows, :3, 3])),
        axis=finely(cut.tool[rows, :3, 2] @ R_feature_base.T),
        moved=finely(case.springs()[:, :3] @ R_feature_base.T),
        bend=finely(curvature(cut.tool[rows, :3, 3]) @ R_feature_base.T),
        late=finely((moving.late[rows] @ R_feature_base.T).reshape(len(rows), -1)).reshape(
            -1, *moving.late.shape[1:]
        ),
        feed=finely(moving.feed[rows, None])[:, 0],
        q=finely(cut.q[rows]),
        direction=moving.direction[rows[behind]],
        wrench=finely(cut.wrench[rows]),
    )
