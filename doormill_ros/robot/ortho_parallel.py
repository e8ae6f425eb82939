"""Lengths and offsets of an ortho-parallel arm with a spherical wrist, from its table.

The closed-form inverse needs seven lengths (Brandstoetter, Angerer, Hofbaur 2014): a1 from
axis 1 to axis 2, a2 from axis 3 to axis 4, b sideways, c1 up to axis 2, c2 lower arm, c3 along axis 4 to
the wrist centre, c4 from there to the flange. Its zero position has both arms straight up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.denavit_hartenberg import ALPHA, THETA_OFFSET, A, D
from doormill_ros.robot.errors import GeometryError

_ALPHA = np.array([-np.pi / 2, 0.0, -np.pi / 2, np.pi / 2, -np.pi / 2, 0.0])
_STRAIGHT_UP = np.array([0.0, -np.pi / 2, -np.pi / 2, 0.0, 0.0, np.pi])  # theta with both arms up


@dataclass(frozen=True)
class OrthoParallel:
    """Arguments of the closed-form inverse: lengths [m] and joint offsets [rad]."""

    a1: float
    a2: float
    b: float
    c1: float
    c2: float
    c3: float
    c4: float
    offsets: tuple[float, ...]


def ortho_parallel(dh: FloatArray, name: str = "the robot") -> OrthoParallel:
    """Derive the arguments from a Denavit-Hartenberg table, shape (6, 4).

    With twists (-90, 0, -90, 90, -90, 0) deg axes 2 and 3 are parallel and across axis 1, and axes 4 to 6
    meet when a4 to a6 and d5 vanish. The closed form counts its angles from both arms straight
    up, which the table reaches at theta = (0, -90, -90, 0, 0, 180) deg: x of frame 2 lies along the
    lower arm, x of frame 3 across the forearm, and the flange's x is turned half round. It subtracts
    its offsets, angle = q - offset, where the table adds them, theta = q + theta_offset. Axis 4 leaves
    axis 3 towards positive x of frame 3, which the closed form counts as negative a2.

    Raises:
        GeometryError: Twists, lengths or offsets that this form cannot express.
    """
    twist = np.abs(np.angle(np.exp(1j * (dh[:, ALPHA] - _ALPHA)))).max()
    straight = np.abs(np.r_[dh[1, D], dh[3:, A], dh[4, D]]).max()
    if twist > 1e-9 or straight > 1e-9:
        raise GeometryError(
            f"{name} has no closed-form inverse here: twists are {twist:.1e} rad and wrist lengths "
            f"{straight:.1e} m off a lower arm in one plane with a spherical wrist, allowed is 1e-9"
        )
    offsets = _STRAIGHT_UP - dh[:, THETA_OFFSET]
    return OrthoParallel(
        a1=float(dh[0, A]),
        a2=float(-dh[2, A]),
        b=float(dh[2, D]),
        c1=float(dh[0, D]),
        c2=float(dh[1, A]),
        c3=float(dh[3, D]),
        c4=float(dh[5, D]),
        offsets=tuple(float(angle) for angle in offsets),
    )
