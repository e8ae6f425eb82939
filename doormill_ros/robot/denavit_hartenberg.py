"""Denavit-Hartenberg table of a chain: A_i = Rz(q_i + theta_offset) Tz(d) Tx(a) Rx(alpha)."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.errors import RobotDescriptionError
from doormill_ros.robot.urdf import JOINTS, Chain

THETA_OFFSET, D, A, ALPHA = range(4)  #: columns of a table

_TINY = 1e-9  # metres or sine of an angle: below it two axes meet or are parallel


def table_of_chain(chain: Chain) -> FloatArray:
    """The table, shape (6, 4) [theta_offset rad, d m, a m, alpha rad], of a chain.

    The axes alone leave choices open; they are made so that the table of the IRB 6600 in the
    thesis (table 2.1) comes out: a is positive; where neighbouring axes meet, the x axis is the
    one that keeps theta_offset smallest; where they are parallel, d is zero.

    Raises:
        RobotDescriptionError: Axis 1 is not the base z axis through the base origin, or axis 6
            is not the flange z axis, so that no table with these frames at its ends exists.
    """
    T = np.eye(4)
    rows = []
    for joint in range(JOINTS):
        if joint == 0 or joint == JOINTS - 1:
            _check_end(chain, joint, T)
        if joint < JOINTS - 1:
            row = _row(T, chain.axes[joint + 1], chain.points[joint + 1])
        else:
            row = _last_row(T, chain.T_base_flange)
        rows.append(row)
        T = T @ link_transform(np.array(row))
    error = np.abs(T - chain.T_base_flange).max()
    if error > 1e-8:
        raise RobotDescriptionError(
            f"the flange is {error:.1e} away from where a Denavit-Hartenberg table can put it, allowed is "
            "1e-8: its z axis must be the last joint axis"
        )
    return _clean(np.array(rows))


def link_transform(row: FloatArray, angle: float = 0.0) -> FloatArray:
    """A_i, shape (4, 4), of one row, shape (4,), at joint angle [rad] (thesis 2.1.1)."""
    theta = angle + row[THETA_OFFSET]
    c, s = np.cos(theta), np.sin(theta)
    ca, sa = np.cos(row[ALPHA]), np.sin(row[ALPHA])
    return np.array(
        [
            [c, -s * ca, s * sa, row[A] * c],
            [s, c * ca, -c * sa, row[A] * s],
            [0.0, sa, ca, row[D]],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def _row(T: FloatArray, axis: FloatArray, point: FloatArray) -> tuple[float, float, float, float]:
    """From frame i-1 (columns of T) to a frame with z along the next axis."""
    x, y, z, origin = T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3]
    cross = np.cross(z, axis)
    to_point = point - origin
    if np.linalg.norm(cross) < _TINY:
        across = to_point - (to_point @ z) * z
        d, a = 0.0, float(np.linalg.norm(across))
        direction = across / a if a > _TINY else x
    else:
        normal = cross / np.linalg.norm(cross)
        # Foot of the common normal on z: solve d z + a normal = point + t axis.
        d, a, _ = np.linalg.solve(np.column_stack([z, normal, -axis]), to_point)
        if abs(a) < _TINY:
            # Either sign of x will do; a tie goes to the positive alpha of the wrist's table.
            direction = normal if normal @ x >= -_TINY else -normal
        else:
            direction = normal * np.sign(a)
        a = abs(a) if abs(a) >= _TINY else 0.0
    theta = float(np.arctan2(direction @ y, direction @ x))
    alpha = float(np.arctan2(np.cross(z, axis) @ direction, z @ axis))
    return theta, float(d), float(a), alpha


def _last_row(T: FloatArray, T_base_flange: FloatArray) -> tuple[float, float, float, float]:
    x, y, z = T[:3, 0], T[:3, 1], T[:3, 2]
    theta = float(np.arctan2(T_base_flange[:3, 0] @ y, T_base_flange[:3, 0] @ x))
    if theta < -np.pi + _TINY:
        theta = np.pi  # the table of the thesis writes a half turn as +pi
    return theta, float((T_base_flange[:3, 3] - T[:3, 3]) @ z), 0.0, 0.0


def _check_end(chain: Chain, joint: int, T: FloatArray) -> None:
    to_point = chain.points[joint] - T[:3, 3]
    tilt = np.linalg.norm(chain.axes[joint] - T[:3, 2])
    distance = np.linalg.norm(to_point - (to_point @ T[:3, 2]) * T[:3, 2])
    if tilt > 1e-8 or distance > 1e-8:
        raise RobotDescriptionError(
            f"axis {joint + 1} is {distance:.1e} m and {tilt:.1e} rad off the z axis of the frame before it, "
            "allowed is 1e-8: put the base frame on axis 1 with z along it"
        )


def _clean(table: FloatArray) -> FloatArray:
    """Replace rounding noise: zero lengths, and angles at whole quarter turns."""
    lengths = table[:, [D, A]]
    lengths[np.abs(lengths) < 1e-12] = 0.0
    angles = table[:, [THETA_OFFSET, ALPHA]]
    quarter = np.round(angles / (np.pi / 2))
    near = np.abs(angles - quarter * (np.pi / 2)) < 1e-9
    angles[near] = (quarter * (np.pi / 2))[near] + 0.0
    return np.column_stack([angles[:, 0], np.round(lengths, 12), angles[:, 1]])
