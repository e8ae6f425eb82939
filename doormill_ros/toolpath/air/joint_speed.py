"""Joint speeds along a plan: slow the tool down in the air, refuse a feed that a joint cannot follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.air.reach import JointPath
from doormill_ros.toolpath.errors import JointSpeedError, PathError
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import Checks
from doormill_ros.units import m_to_mm, rad_to_deg


def joint_speed_shares(steps: Sequence[Step], path: JointPath, robot: Robot) -> FloatArray:
    """Largest share of its speed limit that each joint needs on each step, shape (m, 6).

    Zero for a MoveAbsJ, which the controller times by the joints themselves.
    """
    length = np.array([0.0 if s.kind is MotionKind.ABSOLUTE else s.curve.length for s in steps])
    speed = np.array([s.speed for s in steps])
    way = np.diff(path.fraction) * length[path.step[1:]]  # (n - 1,)
    within = (np.diff(path.step) == 0) & (way > 1e-9)
    time = way[within] / speed[path.step[1:][within]]
    needed = np.abs(np.diff(path.q, axis=0)[within]) / time[:, None] / robot.max_velocity
    shares = np.zeros((len(steps), 6))
    np.maximum.at(shares, path.step[1:][within], needed)
    return shares


def followable(steps: Sequence[Step], path: JointPath, robot: Robot, checks: Checks) -> list[Step]:
    """The plan with every speed in the air lowered to what the joints can follow.

    Raises:
        JointSpeedError: The feed of a cut is too fast for a joint.
    """
    shares = joint_speed_shares(steps, path, robot)
    worst = np.where([step.cutting for step in steps], shares.max(axis=1), 0.0)
    if worst.max() > checks.joint_speed_share:
        raise _too_fast(steps, int(worst.argmax()), shares, robot, checks)
    slower = np.minimum(1.0, checks.joint_speed_share / np.maximum(shares.max(axis=1), 1e-12))
    return [
        s if f == 1.0 else s.changed(speed=s.speed * float(f)) for s, f in zip(steps, slower, strict=True)
    ]


def _too_fast(steps: Sequence[Step], i: int, shares: FloatArray, robot: Robot, checks: Checks) -> PathError:
    step, joint = steps[i], int(shares[i].argmax())
    found = float(shares[i, joint])
    return JointSpeedError(
        f"{step.feature}, motion {i + 1} of {len(steps)}: joint {joint + 1} would turn at "
        f"{rad_to_deg(found * robot.max_velocity[joint]):.0f} deg/s, allowed are "
        f"{rad_to_deg(checks.joint_speed_share * robot.max_velocity[joint]):.0f} deg/s; lower the feed "
        f"from {m_to_mm(step.speed):.0f} to {m_to_mm(step.speed) * checks.joint_speed_share / found:.0f} mm/s",
        feature=step.feature,
        motion=i + 1,
        found=found,
        allowed=checks.joint_speed_share,
    )
