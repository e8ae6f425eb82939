"""Points along every step of a plan at which robot and correction are computed, all at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.correction.loads import Loads
from doormill_ros.frames import rotate_wrench
from doormill_ros.toolpath.curves.curve import points_of
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind

FRACTIONS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
VIA = 2  #: index of the middle, where the circle point of a MoveC lies
STANDSTILL = 1e-9  #: a joint that moves less from station to station keeps its last direction [rad]


@dataclass(frozen=True, eq=False)
class Stations:
    """k stations on each of m steps.

    Attributes:
        T_base_tool: Nominal poses, shape (m, k, 4, 4).
        wrench: Process wrench at the tool centre point, base axes, shape (m, k, 6) [N, N m].
        spread: One standard deviation of each of its components along the tool's axes, written in base axes, shape
            (m, 6, 6) [N, N m]: row after row an independent wrench.
        bounded: Where nobody measured the wrench, shape (m,).
        kind: Of the feature that is milled, shape (m,).
    """

    T_base_tool: FloatArray
    wrench: FloatArray
    spread: FloatArray
    bounded: BoolArray
    kind: npt.NDArray[Any]

    def loads(self, step: IntArray, station: IntArray, direction: FloatArray) -> Loads:
        """The loads at stations of steps, shape (n,) each, while the joints move in directions of shape (n, 6)."""
        return Loads(
            self.wrench[step, station], direction, self.spread[step], self.bounded[step], self.kind[step]
        )


def stations_of(steps: Sequence[Step], T_base_door: FloatArray) -> Stations:
    """Nominal poses and wrenches along all steps.

    A MoveAbsJ does not follow its curve, so all its stations are at its end.

    Args:
        steps: m steps in the door frame.
        T_base_door: Where the door stands, shape (4, 4).
    """
    m, k = len(steps), len(FRACTIONS)
    poses = stations_along(steps, T_base_door, np.repeat(np.arange(m), k), np.tile(FRACTIONS, m))
    R_base_tool = T_base_door[:3, :3] @ np.array([s.R_door_tool for s in steps])  # (m, 3, 3)
    first = rotate_wrench(R_base_tool, np.array([s.wrench_tool for s in steps]))[:, None]  # (m, 1, 6)
    last = rotate_wrench(R_base_tool, np.array([s.last_wrench for s in steps]))[:, None]
    wrench = first + FRACTIONS[:, None] * (last - first)
    std = np.array([s.std_tool for s in steps])[:, :, None] * np.eye(6)  # (m, 6, 6)
    spread = rotate_wrench(R_base_tool[:, None], std)
    bounded = np.array([s.bounded for s in steps])
    kind = np.array([s.kind_of_feature for s in steps])
    return Stations(poses.reshape(m, k, 4, 4), wrench, spread, bounded, kind)


def stations_along(
    steps: Sequence[Step], T_base_door: FloatArray, index: IntArray, fraction: FloatArray
) -> FloatArray:
    """T_base_tool at fractions of steps, shape (n, 4, 4).

    Args:
        steps: The plan.
        T_base_door: Where the door stands, shape (4, 4).
        index: Step of each pose, shape (n,).
        fraction: Fraction 0..1 of the step's length, shape (n,).
    """
    joint = np.array([s.kind is MotionKind.ABSOLUTE for s in steps])
    points = points_of([s.curve for s in steps], index, np.where(joint[index], 1.0, fraction))
    T_base_tool = np.zeros((len(points), 4, 4))
    R_base_tool = T_base_door[:3, :3] @ np.array([s.R_door_tool for s in steps])
    T_base_tool[:, :3, :3] = R_base_tool[index]
    T_base_tool[:, :3, 3] = points @ T_base_door[:3, :3].T + T_base_door[:3, 3]
    T_base_tool[:, 3, 3] = 1.0
    return T_base_tool


def directions(q: FloatArray) -> FloatArray:
    """Sign of each joint's motion at every station.

    A joint that stands still keeps the direction of its last motion, 0 before its first one.

    Args:
        q: Joint angles, shape (m, k, 6) [rad].

    Returns:
        -1, 0 or +1, shape (m, k, 6).
    """
    change = np.empty_like(q)
    change[:, 1:] = np.diff(q, axis=1)
    change[:, 0] = change[:, 1]  # the start of a step belongs to the motion that begins there
    sign = np.where(np.abs(change) > STANDSTILL, np.sign(change), 0.0).reshape(-1, 6)
    # Index of the last moving station at or before each one, joint by joint.
    last = np.where(sign != 0.0, np.arange(len(sign))[:, None], 0)
    np.maximum.accumulate(last, axis=0, out=last)
    return np.take_along_axis(sign, last, axis=0).reshape(q.shape)
