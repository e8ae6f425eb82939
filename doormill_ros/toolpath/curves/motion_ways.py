"""How the tool goes along the MoveL and MoveC of a program, all of them at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import inverse
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.curves.arcs import circles
from doormill_ros.toolpath.program import AT_POINTS, MillingProgram, MotionKind


@dataclass(frozen=True, eq=False)
class MotionWays:
    """Ways of the tool on n motions.

    Attributes:
        known: For a MoveL or MoveC whose beginning is known, shape (n,); of the others nothing is told.
        length: Shape (n,) [m], 0 where it is not known.
        radius: Of a MoveC, infinite for a straight line, shape (n,) [m].
        begin: Unit direction of travel where the motion begins, shape (n, 3).
        end: The same where it ends, shape (n, 3).
    """

    known: BoolArray
    length: FloatArray
    radius: FloatArray
    begin: FloatArray
    end: FloatArray


def motion_ways(program: MillingProgram, places: FloatArray, points: FloatArray | None = None) -> MotionWays:
    """Ways of the tool on the motions of a program.

    Args:
        program: The program.
        places: Where the tool centre point is at its targets, shape (targets, 3) [m].
        points: The same at its points of joint space, shape (points, 3) [m]; None: a way from there is not known.
    """
    motions = program.motions
    n = len(motions)
    by_tool = [motion.kind in (MotionKind.LINEAR, MotionKind.CIRCULAR) for motion in motions]
    at_points = np.array([motion.kind in AT_POINTS for motion in motions], dtype=bool)
    known = np.array(by_tool, dtype=bool)
    known[:1] = False
    if points is None:
        known[1:] &= ~at_points[:-1]
    length, radius, begin, end = np.zeros(n), np.full(n, np.inf), np.zeros((n, 3)), np.zeros((n, 3))
    own = np.flatnonzero(known)
    target = np.array([motion.target for motion in motions])
    via = np.array([-1 if motion.via is None else motion.via for motion in motions])
    ends = places if points is None else np.concatenate([places, points])
    at = np.where(at_points, len(places), 0) + target
    first, last = ends[at[own - 1]], ends[at[own]]
    way = last - first
    length[own] = np.linalg.norm(way, axis=1)
    begin[own] = end[own] = way / np.maximum(length[own], 1e-12)[:, None]
    arcs = np.flatnonzero(via[own] >= 0)
    rows = own[arcs]
    length[rows], radius[rows], begin[rows], end[rows] = circles(first[arcs], places[via[rows]], last[arcs])
    return MotionWays(known, length, radius, begin, end)


def tool_at_points(program: MillingProgram, robot: Robot) -> FloatArray:
    """Where the tool centre point is at the program's points of joint space, shape (points, 3) [m].

    Its place in the flange is that of the first target, which there has to be.
    """
    kinematics, first = Kinematics(robot), program.targets[0]
    T_flange_tool = inverse(kinematics.forward(first.q)) @ first.T_base_tool_corrected
    postures = np.array(program.points, dtype=float).reshape(-1, 6)
    places: FloatArray = (kinematics.forward(postures) @ T_flange_tool)[:, :3, 3]
    return places
