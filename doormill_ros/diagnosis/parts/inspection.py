"""The cell's own products question the model: a milled contour as a loading test.

Where the tool cut, the robot stood in a known posture under a known process wrench, and the
milled wall shows where the tool was, along the wall's normal only. Where it had been sent is
known; the difference is one component of the robot's displacement under the load.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.diagnosis.parts.placement import FreePartProblem, placement_columns
from doormill_ros.frames import rotate_wrench
from doormill_ros.measurements.trials import Noise, Reflector, Trials
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause

#: Causes that have no part in a milled contour: there is no tracker, no reflector and no sensor.
_ABSENT = ("setup", "tracker")
#: Way of the tool around a point on which load and direction must not change [m]: a jump of a tenth of a
#: millimetre shows on the wall over sqrt(2 x radius x jump), 1.4 mm for a 19 mm cutter.
SETTLED = 2.5e-3
STRETCH = 0.02  #: contour points of one stretch of this length are left out together [m]


@dataclass(frozen=True, eq=False)
class InspectedContour:
    """Measured points of one contour and the robot's state where each was cut.

    Attributes:
        point: Points of the nominal wall, base frame, shape (n, 3) [m].
        normal: Unit normals into the wood, base axes, shape (n, 3).
        deviation: Wood missing along the normal, shape (n,) [m]; negative where wood is left.
        sent: How far into the wood the tool had been sent beyond the nominal wall, shape (n,) [m].
        q: Commanded joint angles where the point was cut, shape (n, 6) [rad].
        direction: Last motion of each joint there, shape (n, 6).
        wrench: Process wrench on the tool, base axes, shape (n, 6) [N, N m].
        time: When it was cut, shape (n,) [s].
    """

    point: FloatArray
    normal: FloatArray
    deviation: FloatArray
    sent: FloatArray
    q: FloatArray
    direction: FloatArray
    wrench: FloatArray
    time: FloatArray


def match_contour(
    point: FloatArray,
    normal: FloatArray,
    deviation: FloatArray,
    *,
    tool_radius: float,
    tool: FloatArray,
    q: FloatArray,
    wrench: FloatArray,
    time: FloatArray,
    cutting: FloatArray,
) -> InspectedContour:
    """Find for every contour point the moment at which the tool cut it.

    Args:
        point: Nominal wall at the depth of the tool tip, base frame, shape (n, 3) [m].
        normal: Into the wood, shape (n, 3).
        deviation: Shape (n,) [m].
        tool_radius: Radius of the cutter [m].
        tool: Commanded tool centre points, shape (m, 3) [m], base frame.
        q: Joint angles, shape (m, 6) [rad].
        wrench: Wrench on the tool, base axes, shape (m, 6).
        time: Shape (m,) [s].
        cutting: Samples in the wood, shape (m,).
    """
    moved = np.sign(np.where(np.abs(np.diff(q, axis=0)) > 1e-9, np.diff(q, axis=0), 0.0))
    direction = np.zeros_like(q)
    for i in range(1, len(q)):
        direction[i] = np.where(moved[i - 1] == 0.0, direction[i - 1], moved[i - 1])
    rows = np.flatnonzero(cutting & np.any(wrench != 0.0, axis=1))
    tree = cKDTree(tool[rows])
    centre = point - tool_radius * normal
    at = rows[tree.query(centre)[1]]
    # Where load or direction change, the wall is the envelope of two stretches and belongs to neither.
    steady = np.array(
        [
            bool(np.all(direction[near] == direction[i]) and np.all(wrench[near] == wrench[i]))
            for i, near in zip(at, (rows[n] for n in tree.query_ball_point(centre, SETTLED)), strict=True)
        ]
    )
    at = at[steady]
    sent = np.sum((tool[at] - centre[steady]) * normal[steady], axis=1)
    return InspectedContour(
        point[steady], normal[steady], deviation[steady], sent, q[at], direction[at], wrench[at], time[at]
    )


def part_problem(
    contours: list[InspectedContour],
    robot: Robot,
    T_flange_tool: FloatArray,
    accuracy: float,
    doors: Sequence[int] | None = None,
) -> LoadingProblem:
    """What a robot milled, as a loading test that questions its joint springs.

    Args:
        contours: Inspected contours of one or several parts.
        robot: Which robot milled.
        T_flange_tool: The tool, shape (4, 4).
        accuracy: Standard deviation of a measured deviation [m].
        doors: Number of the door of each contour, -1 where it was measured against the place where it was milled; of
            the others position and angle are unknown. None: all were.

    Returns:
        A problem whose residuals are along the walls' normals.
    """
    joined = {name: np.concatenate([getattr(c, name) for c in contours]) for name in vars(contours[0])}
    tip, n = np.asarray(T_flange_tool)[:3, 3], len(joined["q"])
    along = joined["deviation"] - joined["sent"]
    R_flange_base = np.swapaxes(Kinematics(robot).forward(joined["q"])[:, :3, :3], 1, 2)
    data = Trials(
        robot=robot.name,
        dh=np.array(robot.dh),
        joint_stiffness=np.array(robot.stiffness),
        noise=Noise(accuracy, 0.0, 0.0),
        wrench_frame_rotation=0.0,
        load_point=np.array(tip),
        reflectors={"tool": Reflector(6, np.array(tip))},
        trial=np.arange(1, n + 1),
        time=joined["time"],
        dt=np.zeros(n),
        temperature=np.full(n, np.nan),
        q=joined["q"],
        direction=joined["direction"],
        wrench=rotate_wrench(R_flange_base, joined["wrench"]),
        reflector=np.full(n, "tool"),
        displacement=along[:, None] * joined["normal"],
    )
    groups = _stretches(contours)
    if doors is None or max(doors) < 0:
        return LoadingProblem(data, sight=joined["normal"], groups=groups, allowed=_can_act)
    door = np.concatenate([np.full(len(c.deviation), d) for c, d in zip(contours, doors, strict=True)])
    placement = placement_columns(joined["point"], joined["normal"], door)
    return FreePartProblem(data, sight=joined["normal"], groups=groups, allowed=_can_act, placement=placement)


def _can_act(cause: ElasticCause) -> bool:
    return cause.stage not in _ABSENT


def _stretches(contours: list[InspectedContour]) -> IntArray:
    """Number of the stretch of every point: neighbours know too much of each other."""
    groups, start = [], 0
    for contour in contours:
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(contour.point, axis=0), axis=1))])
        groups.append(start + (way / STRETCH).astype(int))
        start = int(groups[-1].max()) + 1
    return np.concatenate(groups)
