"""Joint angles along a plan, or the sentence that says which target the robot cannot serve."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import inverse
from doormill_ros.robot.branch import choose_branch
from doormill_ros.robot.branch_rules import BranchRules
from doormill_ros.robot.description import Robot
from doormill_ros.robot.errors import (
    BranchError,
    JointLimitError,
    RobotError,
    SingularityError,
    UnreachableError,
)
from doormill_ros.robot.inverse import BRANCHES
from doormill_ros.toolpath.errors import (
    ConfigurationChangeError,
    PathError,
    PathJointLimitError,
    PathSingularityError,
    ReachError,
)
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.toolpath.stations import FRACTIONS, stations_along

SPACING = 0.1  #: poses on a long way are at most this far apart [m]
#: The same in the air, where the joints' ways from pose to pose are taken for straight as near as bodies may pass.
AIR_SPACING = 0.025

_MEANING: dict[type[RobotError], type[PathError]] = {
    UnreachableError: ReachError,
    JointLimitError: PathJointLimitError,
    SingularityError: PathSingularityError,
    BranchError: ConfigurationChangeError,
}


@dataclass(frozen=True, eq=False)
class JointPath:
    """Joint angles along a plan.

    Attributes:
        q: Joint angles of the dense path, shape (n, 6) [rad].
        step: Step that each belongs to, shape (n,).
        fraction: Fraction 0..1 of that step's length, shape (n,).
        stations: At the stations of every step, shape (m, k, 6) [rad].
    """

    q: FloatArray
    step: IntArray
    fraction: FloatArray
    stations: FloatArray


def joint_path(
    steps: Sequence[Step],
    T_base_door: FloatArray,
    robot: Robot,
    T_flange_tool: FloatArray,
    settings: PathSettings,
    branches: Iterable[int] = range(BRANCHES),
    turn_over: bool = False,
) -> JointPath:
    """Joint angles at every station, in one configuration between one MoveAbsJ and the next.

    Args:
        steps: The plan.
        T_base_door: Where the door stands, shape (4, 4).
        robot: Whose joints.
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
        settings: Margins.
        branches: Branches (cfx) to choose from.
        turn_over: Whether the arm may take another posture at a MoveAbsJ.

    Raises:
        ReachError: A target is out of reach.
        PathJointLimitError: A joint would have to go beyond its limit.
        PathSingularityError: The path comes too close to a singularity.
        ConfigurationChangeError: No configuration serves the path up to the next MoveAbsJ.
    """
    index, fraction = _dense(steps)
    T_base_flange = stations_along(steps, T_base_door, index, fraction) @ inverse(T_flange_tool)
    leg = np.cumsum([step.kind is MotionKind.ABSOLUTE for step in steps])
    checks = settings.checks
    rules = BranchRules(
        limit_margin=checks.joint_margin, wrist=checks.wrist, elbow=checks.elbow, shoulder=checks.shoulder
    )
    try:
        q = choose_branch(
            robot, T_base_flange, rules=rules, segment=leg[index], branches=branches, turn_over=turn_over
        )
    except tuple(_MEANING) as error:
        at = int(index[int(error.data.get("pose", 0))])
        feature = next((s.feature for s in [*steps[at:], *steps[:at]] if s.feature), "")
        where = feature if at == 0 or steps[at].feature else f"the way to {feature}"
        raise _MEANING[type(error)](
            f"{where}, motion {at + 1} of {len(steps)}: {error.message}", feature=feature, motion=at + 1
        ) from error
    station = np.isin(fraction, FRACTIONS)
    return JointPath(q, index, fraction, q[station].reshape(len(steps), len(FRACTIONS), 6))


def _dense(steps: Sequence[Step]) -> tuple[IntArray, FloatArray]:
    """Step and fraction of every pose: the stations, and more between them on long ways."""
    fractions = []
    for step in steps:
        spacing = SPACING if step.cutting else AIR_SPACING
        parts = 4 * max(1, math.ceil(step.curve.length / spacing / 4.0))
        few = parts == 4 or step.kind is MotionKind.ABSOLUTE
        fractions.append(FRACTIONS if few else np.arange(parts + 1) / parts)
    index = np.repeat(np.arange(len(steps)), [len(own) for own in fractions])
    return index, np.concatenate(fractions)
