"""Geometry of planned motions as samples: stretches along a motion, and corners from one to the next."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.motions.curves import Corner, corner_joints
from doormill_ros.simulation.controller.moves import PlannedMove
from doormill_ros.simulation.controller.records.recording import Sampling


class Stretch(NamedTuple):
    """Samples of a stretch of path: time at the programmed speed (n,) [s], T_base_tool (n, 4, 4), q (n, 6) [rad]."""

    time: FloatArray
    poses: FloatArray
    q: FloatArray


class Stretches:
    """Samples planned motions for one arm and the tool that is mounted on it."""

    def __init__(self, arm: ControllerArm, T_flange_tool: FloatArray, sampling: Sampling) -> None:
        """Sample for an arm with the tool whose path is recorded, shape (4, 4)."""
        self._arm = arm
        self._T_flange_tool = T_flange_tool
        self._sampling = sampling

    def pose(self, q: FloatArray) -> FloatArray:
        """T_base_tool, shape (4, 4), at joint angles (6,) [rad]."""
        pose: FloatArray = self._arm.forward(q)[0] @ self._T_flange_tool
        return pose

    def along(self, move: PlannedMove, start: float, end: float, q: FloatArray) -> Stretch:
        """From parameter `start` to `end` of a motion; `q` (6,) [rad] are the joint angles at its start."""
        count = self._count(move, end - start)
        u = np.linspace(start, end, count)
        if move.curve is None:
            angles = move.q_start + u[:, None] * (move.q_end - move.q_start)
            flange = self._arm.forward(angles)
        else:
            flange = move.curve.poses(u) @ inverse(move.T_flange_tool)
            angles = self._arm.nearest(flange, q)
        time = np.linspace(0.0, (end - start) * move.duration, count)
        return Stretch(time, flange @ self._T_flange_tool, angles)

    def corner(self, move: PlannedMove, following: PlannedMove, radius: float, q: FloatArray) -> Stretch:
        """Round the corner between two motions on a parabola; an odd number of samples, halves of equal count.

        Args:
            move: The motion that is left, from `radius` [m] before its end on.
            following: The motion that is entered, `radius` after its start.
            radius: See there.
            q: Joint angles where the first one is left, shape (6,) [rad].
        """
        leave, enter = 1.0 - radius / move.length, radius / following.length
        count = max(5, self._count(move, 1.0 - leave) + self._count(following, enter))
        count += 1 - count % 2
        u = np.linspace(0.0, 1.0, count)
        if move.curve is None or following.curve is None:
            angles = corner_joints(q, move.q_end, self._joints_at(following, enter), u)
            flange = self._arm.forward(angles)
        else:
            corner = Corner(
                move.curve.poses(np.array([leave]))[0],
                move.T_base_tool_end,
                following.curve.poses(np.array([enter]))[0],
            )
            flange = corner.poses(u) @ inverse(following.T_flange_tool)
            angles = self._arm.nearest(flange, q)
        half = count // 2
        first = np.linspace(0.0, (1.0 - leave) * move.duration, half + 1)
        second = first[-1] + np.linspace(0.0, enter * following.duration, half + 1)[1:]
        return Stretch(np.concatenate([first, second]), flange @ self._T_flange_tool, angles)

    def joints(self, start: FloatArray, end: FloatArray, duration: float) -> Stretch:
        """From joint angles to others, shape (6,) [rad], at even joint speeds in a time [s]."""
        u = np.linspace(0.0, 1.0, int(np.ceil(duration / self._sampling.interval)) + 2)
        angles = start + u[:, None] * (end - start)
        return Stretch(u * duration, self._arm.forward(angles) @ self._T_flange_tool, angles)

    def samples(self, time: FloatArray, q: FloatArray) -> Stretch:
        """Joint angles (n, 6) [rad] at times (n,) [s] with their poses."""
        return Stretch(time, self._arm.forward(q) @ self._T_flange_tool, q)

    def _joints_at(self, move: PlannedMove, u: float) -> FloatArray:
        """Joint angles at parameter u of a motion, shape (6,) [rad]."""
        if move.curve is None:
            return move.q_start + u * (move.q_end - move.q_start)
        poses = move.curve.poses(np.linspace(0.0, u, 11)) @ inverse(move.T_flange_tool)
        q: FloatArray = self._arm.nearest(poses, move.q_start)[-1]
        return q

    def _count(self, move: PlannedMove, span: float) -> int:
        """Samples for a share of a motion, ends included."""
        by_time = span * move.duration / self._sampling.interval
        by_way = span * move.length / self._sampling.cutting_step if move.context.cutting else 0.0
        return int(np.ceil(max(by_time, by_way))) + 2
