"""What error is expected of the finished walls, and a door refused whose error would be too large."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.loads import Loads
from doormill_ros.toolpath.errors import ExpectedErrorError
from doormill_ros.toolpath.settings import Checks
from doormill_ros.units import m_to_mm


@dataclass(frozen=True, eq=False)
class ExpectedErrors:
    """Expected errors of n targets, 0 where no wall is finished.

    Attributes:
        total: Root mean square of all, shape (n,) [m].
        left: What the correction leaves of the predicted deflection, shape (n,) [m].
        joints: What the spring of each joint leaves to chance, shape (n, 6) [m].
        force: What the force leaves to chance, shape (n,) [m].
        weights: What the masses of tool and links leave to chance, shape (n,) [m].
        bounded: Where nobody measured the force, shape (n,).
    """

    total: FloatArray
    left: FloatArray
    joints: FloatArray
    force: FloatArray
    weights: FloatArray
    bounded: BoolArray


def expected_errors(
    loaded: LoadedRobot,
    q: FloatArray,
    moved: FloatArray,
    owner: IntArray,
    loads: Loads,
    deflection: FloatArray,
    wall: BoolArray,
) -> ExpectedErrors:
    """The largest expected error at each target, of the loads under which it finishes a wall.

    Args:
        loaded: Robot, model, and what its corrections are worth.
        q: Joint angles sent, shape (n, 6) [rad].
        moved: From nominal to corrected places, shape (n, 3) [m].
        owner: Target of each load, shape (e,).
        loads: e loads.
        deflection: Under each load, shape (e, 6) [m, rad].
        wall: Which loads act while a wall is finished, shape (e,).
    """
    n = len(q)
    left = np.linalg.norm(deflection[:, :3] + moved[owner], axis=1) * wall
    joints = np.zeros((len(owner), 6))
    force: FloatArray = np.zeros(len(owner))
    weights: FloatArray = np.zeros(len(owner))
    if loaded.worth is not None:
        at, standing = q[owner], loaded.standing_spread(q[owner])
        spread = loaded.spread(loaded.worth, at, loads, standing)
        joints, force, weights = spread.joints * wall[:, None], spread.force * wall, spread.weights * wall
    total = np.sqrt(left**2 + np.sum(joints**2, axis=1) + force**2 + weights**2)
    order = np.argsort(total, kind="stable")
    worst = np.zeros(n, dtype=int)
    worst[owner[order]] = order  # the last written is the largest
    return ExpectedErrors(
        total[worst], left[worst], joints[worst], force[worst], weights[worst], loads.bounded[worst]
    )


def check_expected(found: ExpectedErrors, names: Sequence[tuple[str, str]], checks: Checks) -> None:
    """Refuse a door of which some wall is expected to be too far off.

    Args:
        found: At each target.
        names: Feature and name of each target.
        checks: What is allowed.

    Raises:
        ExpectedErrorError: It names the figure that would help most to measure.
    """
    worst = int(found.total.argmax())
    if found.total[worst] <= checks.expected_error:
        return
    feature, target = names[worst]
    joint = int(found.joints[worst].argmax())
    # What a bounded correction leaves is left because nobody measured the force.
    left = found.left[worst] if found.bounded[worst] else 0.0
    by_force = float(np.hypot(found.force[worst], left))
    by_joint, by_weights = float(found.joints[worst, joint]), float(found.weights[worst])
    if by_weights > max(by_force, by_joint):
        help_ = f"the masses of tool and links ({m_to_mm(by_weights):.2f} mm; weigh them, or teach nearer to the door)"
    elif by_force >= by_joint:
        help_ = f"the process force of {feature} ({m_to_mm(by_force):.2f} mm; identify --milling)"
    else:
        help_ = f"the stiffness of joint {joint + 1} ({m_to_mm(by_joint):.2f} mm; identify)"
    raise ExpectedErrorError(
        f"{feature}, target {target}: its wall is expected to be {m_to_mm(found.total[worst]):.2f} mm off, allowed are "
        f"{m_to_mm(checks.expected_error):.2f} mm; it would help most to measure {help_}, or mill with less chip load "
        "or depth",
        feature=feature,
        target=target,
        found=float(found.total[worst]),
        allowed=checks.expected_error,
    )
