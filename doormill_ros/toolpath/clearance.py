"""See that mill and spindle stay clear of the door: on the way between features, and over a pocket.

The mill is a cylinder, and so is the spindle behind it (`approach.nose` and `approach.spindle_radius` of
config/toolpath.yaml). The arm that carries them and the clamp are not looked at.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.frames import apply, inverse
from doormill_ros.recipes.door import DoorSize
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.errors import AirMoveError, HolderError
from doormill_ros.toolpath.operation import Operation
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.reach import JointPath
from doormill_ros.toolpath.settings import Approach
from doormill_ros.units import m_to_mm

MARGIN = 0.010  #: mill and spindle keep this far from the door [m]
SAMPLES = 21  #: postures looked at on a MoveJ
AXIS_STEP = 0.01  #: distance of the points looked at along the spindle axis [m]


def check_holder(operations: Sequence[Operation], approach: Approach) -> None:
    """See that the spindle does not meet the surface over a deep pocket.

    Args:
        operations: What the robot mills.
        approach: Where the spindle begins.

    Raises:
        HolderError: A feature is deeper than the mill reaches out of the spindle.
    """
    allowed = approach.nose - MARGIN
    for item in operations:
        if item.depth > allowed:
            raise HolderError(
                f"{item.feature.id}: it is {m_to_mm(item.depth):.1f} mm deep, allowed are {m_to_mm(allowed):.1f} "
                f"mm, where the spindle is {m_to_mm(MARGIN):.0f} mm off the surface; mill it from both sides, "
                "or measure approach.nose again",
                feature=item.feature.id,
                found=item.depth,
                allowed=allowed,
            )


def check_air(
    steps: Sequence[Step],
    path: JointPath,
    size: DoorSize,
    T_base_door: FloatArray,
    robot: Robot,
    layout: CellLayout,
    approach: Approach,
) -> None:
    """See that mill and spindle stay clear of the door on every motion between features but the first.

    Args:
        steps: The plan.
        path: Joint angles along it.
        size: Of the door.
        T_base_door: Where it stands, shape (4, 4).
        robot: Who moves.
        layout: Its tool.
        approach: Shape of the spindle.

    Raises:
        AirMoveError: A motion comes too close.
    """
    between = [i for i, step in enumerate(steps) if i and not step.feature]
    if not between:
        return
    postures = [_postures(steps[i], i, path) for i in between]
    owner = np.repeat(np.arange(len(between)), [len(q) for q in postures])
    gap = np.full(len(between), np.inf)
    np.minimum.at(gap, owner, _gaps(np.concatenate(postures), size, T_base_door, robot, layout, approach))
    worst = int(gap.argmin())
    if gap[worst] < MARGIN:
        i = between[worst]
        feature = next((s.feature for s in steps[i:] if s.feature), "")
        raise AirMoveError(
            f"{feature}, motion {i + 1} of {len(steps)}: on the way there the tool passes the door at "
            f"{m_to_mm(gap[worst]):.0f} mm, allowed are {m_to_mm(MARGIN):.0f} mm; raise approach.retreats",
            feature=feature,
            motion=i + 1,
            found=float(gap[worst]),
            allowed=MARGIN,
        )


def _postures(step: Step, index: int, path: JointPath) -> FloatArray:
    """Joint angles along a motion, shape (n, 6) [rad]."""
    if step.kind is not MotionKind.JOINT:
        followed: FloatArray = path.q[path.step == index]
        return followed
    start, end = path.stations[index - 1, -1], path.stations[index, -1]
    turned: FloatArray = start + np.linspace(0.0, 1.0, SAMPLES)[:, None] * (end - start)
    return turned


def _gaps(
    q: FloatArray,
    size: DoorSize,
    T_base_door: FloatArray,
    robot: Robot,
    layout: CellLayout,
    approach: Approach,
) -> FloatArray:
    """Distance between the door and mill or spindle, the nearer of them, shape (n,) [m].

    Round every point of the axis the cylinder is taken for a ball, which is never too small.
    """
    length = float(np.linalg.norm(layout.T_flange_tool[:3, 3]))
    behind = np.linspace(0.0, length, max(2, round(length / AXIS_STEP) + 1))  # from the tip
    radius = np.where(behind < approach.nose, approach.mill_radius, approach.spindle_radius)
    T_base_flange = Kinematics(robot).forward(q)
    tip = (T_base_flange @ layout.T_flange_tool)[:, :3, 3]
    back = (T_base_flange[:, :3, 3] - tip) / length
    points = apply(inverse(T_base_door), tip[:, None] + behind[:, None] * back[:, None])
    high = np.array([size.thickness, size.width, size.height])
    outside = np.maximum(np.maximum(-points, points - high), 0.0)  # (n, points, 3)
    inside = np.minimum(np.maximum(-points, points - high).max(axis=-1), 0.0)
    gap: FloatArray = np.linalg.norm(outside, axis=-1) + inside - radius
    nearest: FloatArray = gap.min(axis=-1)
    return nearest
