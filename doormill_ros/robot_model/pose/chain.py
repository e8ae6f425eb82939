"""Forward model of a robot whose frames are displaced a little, and its exact first derivatives.

`T_base_target = exp(xi_0) A_1 exp(xi_1) ... A_J exp(xi_J) T_flange_target` with the nominal link
transforms A_k (Rz Tz Tx Rx) of J joints and one small twist for each DH frame k, in the axes of that frame:
what a cause does is said as components of these twists. A turn of joint k is the rotation about
z of frame k - 1; an offset of link k along its x is the translation along x of frame k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross, displacement, vector_from_rotation

AXES = 6  #: translation x, y, z, rotation x, y, z


def direction(frame: int, axis: int) -> int:
    """Number of a component of a frame's twist; axis 0..2 moves, 3..5 turns."""
    return AXES * frame + axis


def joint_turn(joint: int) -> int:
    """Direction in which joint 1..J turns."""
    return direction(joint - 1, 5)


def link_transforms(dh: FloatArray, q: FloatArray) -> FloatArray:
    """A_1 ... A_J for joint angles (n, J), shape (n, J, 4, 4)."""
    theta = q + dh[:, 0]
    d, a, alpha = dh[:, 1], dh[:, 2], dh[:, 3]
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    A = np.zeros((*theta.shape, 4, 4))
    A[..., 0, 0], A[..., 0, 1], A[..., 0, 2], A[..., 0, 3] = c, -s * ca, s * sa, a * c
    A[..., 1, 0], A[..., 1, 1], A[..., 1, 2], A[..., 1, 3] = s, c * ca, -c * sa, a * s
    A[..., 2, 1], A[..., 2, 2], A[..., 2, 3] = sa, ca, d
    A[..., 3, 3] = 1.0
    return A


def frames(links: FloatArray, twists: FloatArray | None = None) -> FloatArray:
    """T_base_k of the displaced frames k = 0..J, shape (n, J + 1, 4, 4).

    Args:
        links: A_1 ... A_J, shape (n, J, 4, 4).
        twists: xi_0 ... xi_J, shape (n, J + 1, 6), or None for the nominal robot.
    """
    n, count = len(links), links.shape[1] + 1
    T = np.broadcast_to(np.eye(4), (n, 4, 4))
    out = np.empty((n, count, 4, 4))
    for k in range(count):
        if k:
            T = T @ links[:, k - 1]
        if twists is not None:
            T = T @ displacement(twists[:, k])
        out[:, k] = T
    return out


@dataclass(frozen=True, eq=False)
class Placement:
    """Where a set stands: T_tracker_base and T_flange_target, shape (4, 4) each."""

    T_tracker_base: FloatArray
    T_flange_target: FloatArray

    def moved(self, base: FloatArray, target: FloatArray) -> Placement:
        """Shifted by a twist of the base (base axes) and one of the flange (flange axes), shape (6,)."""
        return Placement(
            self.T_tracker_base @ displacement(base), displacement(target) @ self.T_flange_target
        )


def residual(
    T_base_frames: FloatArray, placement: Placement, position: FloatArray, rotation: FloatArray | None
) -> FloatArray:
    """Measured minus modelled pose in base axes: translation [m] and rotation vector [rad], shape (n, 6).

    The rotation is zero where none was measured; whoever counts it weighs it with zero (`per_axis`).
    """
    T = T_base_frames[:, -1] @ placement.T_flange_target
    R_base_tracker = placement.T_tracker_base[:3, :3].T
    measured = (position - placement.T_tracker_base[:3, 3]) @ R_base_tracker.T
    if rotation is None:
        return np.concatenate([measured - T[:, :3, 3], np.zeros(measured.shape)], axis=1)
    turn = (R_base_tracker @ rotation) @ np.swapaxes(T[:, :3, :3], 1, 2)
    return np.concatenate([measured - T[:, :3, 3], vector_from_rotation(turn)], axis=1)


def derivatives(T_base_frames: FloatArray, placement: Placement) -> FloatArray:
    """Motion of the target for a unit of every frame twist, base axes, shape (n, 6 J + 6, 6)."""
    n, count = T_base_frames.shape[:2]
    target = T_base_frames[:, -1] @ placement.T_flange_target[:, 3]
    out = np.zeros((n, count, AXES, 6))
    axes = np.swapaxes(T_base_frames[..., :3, :3], -1, -2)  # (n, J + 1, axis, component)
    lever = target[:, None, :3] - T_base_frames[..., :3, 3]
    out[:, :, :3, :3] = axes
    out[:, :, 3:, :3] = cross(axes, lever[:, :, None, :])
    out[:, :, 3:, 3:] = axes
    return out.reshape(n, AXES * count, 6)


def per_axis(sigma: tuple[float, float], oriented: bool) -> FloatArray:
    """One over the standard deviations of a residual's components, shape (6,); zero for what was not measured.

    Args:
        sigma: Per axis, position [m] and rotation [rad].
        oriented: Whether the target's orientation was measured.
    """
    return np.repeat([1.0 / sigma[0], 1.0 / sigma[1] if oriented else 0.0], 3)


def free_directions(joints: int, oriented: bool) -> list[int]:
    """Directions of a placement: the base, and the target on the flange, which without orientation is a point."""
    target = direction(joints, 0)
    return [*range(AXES), *range(target, target + (AXES if oriented else 3))]
