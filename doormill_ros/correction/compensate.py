"""Find the commanded posture whose loaded tool stands on the nominal pose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import apply_twist, twist_between
from doormill_ros.robot.kinematics import Kinematics

MAX_ITERATIONS = 25
FULL_STEPS = 8
# A turn of this many radians moves the tip of a 1 m lever by one tolerance of translation.
ROTATION_PER_METRE = 1.0


@dataclass(frozen=True, eq=False)
class Compensation:
    """Corrected poses of n targets.

    Attributes:
        T_base_tool: Pose to command, shape (n, 4, 4).
        q: Joint angles at that pose, shape (n, 6) [rad].
        deflection: Predicted twist of the loaded tool there, base axes, shape (n, 6) [m, rad].
        residual: How far the loaded tool stays from the nominal pose, shape (n,) [m].
        iterations: Steps taken until the last target had settled.
    """

    T_base_tool: FloatArray
    q: FloatArray
    deflection: FloatArray
    residual: FloatArray
    iterations: int

    @property
    def translation(self) -> FloatArray:
        """Length of the predicted deflection at the tool centre point, shape (n,) [m]."""
        length: FloatArray = np.linalg.norm(self.deflection[:, :3], axis=1)
        return length

    def replaced(self, rows: IntArray, others: Compensation) -> Compensation:
        """With other targets in the place of some, shape (m,)."""
        columns: dict[str, Any] = {}
        for name in ("T_base_tool", "q", "deflection", "residual"):
            columns[name] = getattr(self, name).copy()
            columns[name][rows] = getattr(others, name)
        return replace(self, **columns, iterations=max(self.iterations, others.iterations))


def compensate(
    T_base_tool: FloatArray,
    q: FloatArray,
    deflect: Callable[[FloatArray], FloatArray],
    kinematics: Kinematics,
    T_flange_tool: FloatArray,
    tolerance: float = 1e-6,
) -> Compensation:
    """Iterate joint angles until the loaded tool is back on the nominal poses.

    The loaded tool stands at `apply_twist(forward(q), deflect(q))`, with the deflection taken at the
    true posture q of every step. What is missing to the nominal pose is made up through the
    inverse Jacobian of the nominal posture; the deflection changes so little over a correction
    of a millimetre that three or four steps reach a micrometre. Orientation is corrected too.

    A model with steps (play in a gear) may have no solution: the torque of a joint changes sign
    within the correction. Such targets come to rest at the step and keep its nearer side as residual.

    Args:
        T_base_tool: Nominal poses, shape (n, 4, 4).
        q: Joint angles that reach them unloaded, shape (n, 6) [rad].
        deflect: Twist of the loaded tool, shape (n, 6), for joint angles of shape (n, 6).
        kinematics: Forward kinematics and Jacobian (`doormill_ros.robot.kinematics.Kinematics`).
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
        tolerance: Accepted residual, translation [m] and rotation at a lever of 1 m.

    Returns:
        The corrected poses; compare `residual` with the tolerance.
    """
    q = np.array(q, dtype=float)
    point = T_flange_tool[:3, 3]
    J = kinematics.jacobian(q, point)  # (n, 6, 6)
    for iterations in range(1, MAX_ITERATIONS + 1):
        T_base_commanded = kinematics.forward(q) @ T_flange_tool
        deflection = deflect(q)
        missing = twist_between(apply_twist(T_base_commanded, deflection), T_base_tool)  # (n, 6)
        size = np.maximum(
            np.linalg.norm(missing[:, :3], axis=1),
            np.linalg.norm(missing[:, 3:], axis=1) * ROTATION_PER_METRE,
        )
        off = np.flatnonzero(size > tolerance)
        if not len(off) or iterations == MAX_ITERATIONS:
            break
        # Full steps first; later ones get smaller so that a target at a step comes to rest on it.
        share = 0.5 ** max(0, iterations - FULL_STEPS)
        q = q.copy()
        q[off] += share * np.linalg.solve(J[off], missing[off, :, None])[..., 0]
    return Compensation(T_base_commanded, q, deflection, size, iterations)
