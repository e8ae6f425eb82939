"""One joint after the other, as the thesis does it: isolate, subtract what is known, divide.

For the joint at hand the trials are taken in which it moves the reflector most against the joints not yet
known. Its stiffness follows from torque and lever,

    K_k = tau_k L_2 / L                                           (2.45, 3.1, 3.3, 3.5, 3.30)
    L = |d - sum of the known joints' displacements|              (3.2, 3.4, 3.6, 3.31)
    d_j = J_j tau_j / K_j,   tau = J^T W                          (3.7, 3.8, 3.32, 3.33; 2.34)

with L_2 = |J_k|, the distance of the reflector from the joint axis, and F L_1 = tau_k. Unlike
appendix A.10 the known joints' displacement is taken at the reflector, not at the tool.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.loading import Loadings, displacement_per_compliance
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.kinematics import Kinematics

#: Share of the unknown displacement that has to be the joint's own to speak of isolation.
ISOLATION = 0.5
#: Number of best isolated trials that are averaged.
TRIALS = 12


@dataclass(frozen=True, eq=False)
class JointStep:
    """How one joint came out.

    Attributes:
        joint: Number 1..6.
        stiffness: Pooled over the trials used [N m/rad], NaN when no trial isolates the joint.
        std: Standard deviation from the scatter between trials [N m/rad], NaN when unknown.
        isolation: Mean share of the joint in the displacement of unknown joints, 0..1.
        trials: Rows of the trials used.
        subtracted: Numbers of the joints whose displacement was taken off first.
    """

    joint: int
    stiffness: float
    std: float
    isolation: float
    trials: tuple[int, ...]
    subtracted: tuple[int, ...]


def identify_joint_by_joint(
    kinematics: Kinematics, loadings: Loadings, reference: FloatArray
) -> list[JointStep]:
    """Apply the thesis' formulas to the best isolated trials, the best isolated joint first.

    Args:
        kinematics: Of the robot that was loaded.
        loadings: The trials.
        reference: Rough joint stiffness, shape (6,) [N m/rad]; decides only the order and the choice of
            trials.

    Returns:
        Six steps in the order in which they were taken.
    """
    A = displacement_per_compliance(kinematics, loadings)  # (n, 3, 6)
    expected = np.linalg.norm(A, axis=1) / np.asarray(reference, dtype=float)  # (n, 6)
    known: dict[int, float] = {}
    steps: list[JointStep] = []
    left = list(range(JOINTS))
    while left:
        # A share of a displacement that drowns in noise isolates nothing.
        floor = 3.0 * loadings.displacement_std.mean()
        share = expected[:, left] / (expected[:, left].sum(axis=1, keepdims=True) + floor)  # (n, left)
        count = min(TRIALS, len(loadings))
        best = np.sort(share, axis=0)[-count:].mean(axis=0)
        joint = left.pop(int(best.argmax()))
        column = share[:, int(best.argmax())]
        rows = np.argsort(column)[::-1][:count]
        rows = rows[column[rows] >= ISOLATION]
        step = _step(A, loadings, joint, rows, known, float(column[rows].mean()) if rows.size else 0.0)
        steps.append(step)
        if np.isfinite(step.stiffness):
            known[joint] = step.stiffness
    return steps


def _step(
    A: FloatArray, loadings: Loadings, joint: int, rows: FloatArray, known: dict[int, float], isolation: float
) -> JointStep:
    subtracted = tuple(sorted(j + 1 for j in known))
    if not rows.size:
        return JointStep(joint + 1, float("nan"), float("nan"), isolation, (), subtracted)
    own = loadings.displacement[rows].copy()
    for other, stiffness in known.items():
        own -= A[rows, :, other] / stiffness  # (3.6), (3.31)
    torque_times_lever = np.linalg.norm(A[rows, :, joint], axis=1)  # F L_1 L_2
    length = np.linalg.norm(own, axis=1)  # L
    # (3.1), (3.3), (3.5), (3.30), pooled: a trial counts as much as its displacement is long.
    stiffness = torque_times_lever.sum() / length.sum()
    scatter = torque_times_lever / stiffness - length
    spread = float("nan")
    if rows.size > 1:
        spread = stiffness * scatter.std(ddof=1) * np.sqrt(rows.size) / length.sum()
    return JointStep(
        joint=joint + 1,
        stiffness=float(stiffness),
        std=float(spread),
        isolation=isolation,
        trials=tuple(int(row) for row in np.sort(rows)),
        subtracted=subtracted,
    )
