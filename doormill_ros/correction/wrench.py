"""Process wrenches: from where and how a force sensor reads them to where the tool cuts.

The thesis logs the process force with a sensor between flange and spindle and turns the
readings about the flange z axis before it takes the means of table 4.8 (appendix A.16), so the
table is in flange axes. Two things in the table say where and how these axes lie:

* In the poses of table 4.6 the flange x axis points along base -y and the flange y axis along
  base -z. The spindle's weight is then on y, and y is the axis on which appendix A.16 plots
  -350 to -170 N, while the means of the table come without it.
* The moments are those of forces at the tip of the tool: Mx = -a Fy and My = a Fx hold with one
  arm a, 0.21 m, to within the rounding for the strongest segment. So the table speaks about the
  sensor, and the moment about the tool tip is what is left after `moved` with that arm.

The sign is taken as the wrench on the robot; the thesis does not state it.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray


def moved(wrench: FloatArray, arm: FloatArray) -> FloatArray:
    """The same load, stated at another point.

    Args:
        wrench: Force and moment, shape (..., 6) [N, N m].
        arm: From the old point to the new one, same axes, shape (3,) [m].

    Returns:
        Shape (..., 6).
    """
    wrench = np.asarray(wrench, dtype=float)
    moment = wrench[..., 3:] - np.cross(arm, wrench[..., :3])
    return np.concatenate([wrench[..., :3], moment], axis=-1)


def turned(R_a_b: FloatArray, wrench_b: FloatArray) -> FloatArray:
    """Wrenches in the axes of b written in the axes of a.

    Args:
        R_a_b: Rotations, shape (..., 3, 3).
        wrench_b: Shape (..., 6) [N, N m].

    Returns:
        Shape (..., 6).
    """
    wrench_b = np.asarray(wrench_b, dtype=float)
    force = np.einsum("...ij,...j->...i", R_a_b, wrench_b[..., :3])
    moment = np.einsum("...ij,...j->...i", R_a_b, wrench_b[..., 3:])
    return np.concatenate([force, moment], axis=-1)


def lever_arm(wrenches: FloatArray) -> float:
    """Distance along z between a sensor and the point where pure forces explain its moments.

    Least squares over Mx = -a Fy and My = a Fx.

    Args:
        wrenches: Sensor readings, z along the tool, shape (n, 6) [N, N m].

    Returns:
        The arm a [m].
    """
    wrenches = np.asarray(wrenches, dtype=float)
    forces = np.concatenate([-wrenches[:, 1], wrenches[:, 0]])  # (2 n,)
    moments = np.concatenate([wrenches[:, 3], wrenches[:, 4]])
    return float(forces @ moments / (forces @ forces))
