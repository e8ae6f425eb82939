"""Closed-form inverse kinematics: every branch.

The eight branches come from py-opw-kinematics. Branches are numbered like RAPID's cfx: 4 when
the wrist centre is behind axis 1, plus 2 when it is behind the lower arm, plus 1 when axis 5 is
negative.
"""

from __future__ import annotations

import functools
from dataclasses import asdict, dataclass

import numpy as np
import py_opw_kinematics as opw

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import rotation_x
from doormill_ros.robot.chain import JOINTS, chain_frames
from doormill_ros.robot.description import Robot
from doormill_ros.robot.ortho_parallel import OrthoParallel, ortho_parallel

BRANCHES = 8
_TURN = 2.0 * np.pi
_SLOT_OF_BRANCH = [4 * (b & 1) + 2 * (b >> 2 & 1) + (b >> 1 & 1) for b in range(BRANCHES)]
_FLAT_WRIST = 1e-3  # sine of axis 5 below which the library's arc cosine loses digits
_NUDGE = 1e-5  # rad
_NUDGED = rotation_x(_NUDGE)
_ALIGNED_WRIST = 1e-10  # sine of axis 5 below which only the sum of axes 4 and 6 is defined
# Limits that nothing satisfies: the library then skips singular values that nobody asked for.
_NO_LIMITS = np.tile([1e3, 1e3 + 1.0], (JOINTS, 1))


def inverse_branches(robot: Robot, T_base_flange: FloatArray) -> FloatArray:
    """The eight branches without regard to limits, each angle in (-pi, pi].

    Args:
        robot: The robot.
        T_base_flange: Poses, shape (n, 4, 4).

    Returns:
        Shape (n, 8, 6) [rad]; NaN where a branch does not exist.

    Raises:
        GeometryError: The robot has no closed-form inverse here.
    """
    arm = _arm_of(robot)
    T_base_flange = np.asarray(T_base_flange, dtype=float)
    q = _library_branches(arm, T_base_flange)
    # Where axis 5 is straight the library may take the arc cosine of a hair more than one and give
    # the branch up. Solved for a pose turned a little about the wrist centre, which leaves axes 1
    # to 3 alone, the branch comes back; axes 4 to 6 are put right below.
    lost = np.nonzero(np.isnan(q[..., 0]).any(axis=1))[0]
    if len(lost):
        again = _library_branches(arm, _turned_about_wrist(arm, T_base_flange[lost]))
        straight = np.abs(np.sin(again[..., 4])) < 2.0 * _NUDGE
        q[lost] = np.where((np.isnan(q[lost, :, 0]) & straight)[..., None], again, q[lost])
    q -= _TURN * np.round(q / _TURN)
    q[q <= -np.pi] += _TURN
    pose, branch = np.nonzero(np.abs(np.sin(q[..., 4])) < _FLAT_WRIST)
    if len(pose):
        q[pose, branch] = _exact_wrist(robot, q[pose, branch], T_base_flange[pose], branch & 1)
    return q


def inverse_near(robot: Robot, T_base_flange: FloatArray, q: FloatArray) -> FloatArray:
    """The solution of each pose that is nearest to a posture, whole turns of the joints included.

    Args:
        robot: The robot.
        T_base_flange: Poses, shape (n, 4, 4).
        q: The posture, shape (6,) [rad].

    Returns:
        Shape (n, 6) [rad], without regard to limits; NaN where a pose is out of reach.

    Raises:
        GeometryError: The robot has no closed-form inverse here.
    """
    found = inverse_branches(robot, T_base_flange)
    found = found + _TURN * np.round((q - found) / _TURN)
    apart = np.nan_to_num(np.abs(found - q).max(axis=2), nan=np.inf)  # (n, 8)
    nearest: FloatArray = found[np.arange(len(found)), apart.argmin(axis=1)]
    return nearest


def _library_branches(arm: OrthoParallel, T_base_flange: FloatArray) -> FloatArray:
    joints: FloatArray = _solver(arm).reach(_Poses(T_base_flange), _NO_LIMITS).joints
    return joints[:, _SLOT_OF_BRANCH]


@dataclass(frozen=True, eq=False)
class _Poses:
    """What the library asks of SciPy's RigidTransform, without making each rotation orthogonal once more."""

    matrix: FloatArray

    def as_matrix(self) -> FloatArray:
        """Shape (n, 4, 4)."""
        return self.matrix


def _turned_about_wrist(arm: OrthoParallel, T_base_flange: FloatArray) -> FloatArray:
    turned = T_base_flange.copy()
    wrist = T_base_flange[:, :3, 3] - arm.c4 * T_base_flange[:, :3, 2]
    turned[:, :3, :3] = T_base_flange[:, :3, :3] @ _NUDGED
    turned[:, :3, 3] = wrist + arm.c4 * turned[:, :3, 2]
    return turned


@functools.lru_cache(maxsize=8)
def _arm_of(robot: Robot) -> OrthoParallel:
    return ortho_parallel(robot.dh, robot.label)


@functools.cache
def _solver(arm: OrthoParallel) -> opw.Robot:
    return opw.Robot(opw.KinematicModel(**asdict(arm)), degrees=False)


def _exact_wrist(robot: Robot, q: FloatArray, T_base_flange: FloatArray, flip: IntArray) -> FloatArray:
    """Axes 4 to 6 from the wrist rotation by arc tangents, exact where axis 5 is almost straight.

    Follows thesis eq. 2.24 to 2.27 with atan2 in place of the arc cosine. `flip` is 1 where axis 5 is
    to be negative.
    """
    frames = chain_frames(robot.dh, np.ascontiguousarray(q.T))
    R_base_3 = np.stack([frames.x[3], frames.y[3], frames.z[3]], axis=1).transpose(2, 0, 1)  # (m, 3, 3)
    R = R_base_3.transpose(0, 2, 1) @ T_base_flange[:, :3, :3]
    sign = 1.0 - 2.0 * flip
    # With twists 90, -90, 0 deg: R = Rz(t4) Ry(-t5) Rz(t6) for table angles t = q + theta_offset.
    sine = np.hypot(R[:, 0, 2], R[:, 1, 2])
    theta5 = sign * np.arctan2(sine, R[:, 2, 2])
    aligned = sine < _ALIGNED_WRIST
    theta4 = np.where(aligned, np.pi * flip, np.arctan2(-sign * R[:, 1, 2], -sign * R[:, 0, 2]))
    c4, s4 = np.cos(theta4), np.sin(theta4)
    theta6 = np.arctan2(c4 * R[:, 1, 0] - s4 * R[:, 0, 0], c4 * R[:, 1, 1] - s4 * R[:, 0, 1])
    q = q.copy()
    q[:, 3:] = np.stack([theta4, theta5, theta6], axis=1) - robot.dh[3:, 0]
    q[:, 3:] -= _TURN * np.round(q[:, 3:] / _TURN)
    return q
