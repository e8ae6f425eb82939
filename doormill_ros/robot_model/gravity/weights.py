"""Weights on an arm and the torques that they make in its joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.units import GRAVITY

FLANGE = 6  #: the link that turns with the last joint


@dataclass(frozen=True, eq=False)
class Weight:
    """Something heavy that rides on a link.

    Attributes:
        link: 1 to 6, the flange.
        mass: [kg].
        std: Standard deviation of the mass [kg].
        centre: Of mass, in the link's Denavit-Hartenberg frame, shape (3,) [m].
        carried: Share of its torque about each joint that the gears carry, shape (6,).
        carried_std: Its standard deviation, shape (6,).
    """

    link: int
    mass: float
    std: float
    centre: FloatArray
    carried: FloatArray
    carried_std: FloatArray


def torque_by_mass(kinematics: Kinematics, q: FloatArray, weights: Sequence[Weight]) -> FloatArray:
    """Torque of gravity about each joint for one kilogram of each of w weights.

    The virtual work of a weight that rises by J_z: tau = -g J_z^T, with the z row of the Jacobian of its centre.

    Args:
        kinematics: Of the arm, base z up.
        q: Joint angles, shape (n, 6) [rad].
        weights: w weights; their masses do not matter here.

    Returns:
        Shape (n, w, 6) [N m / kg].
    """
    found = np.zeros((len(q), len(weights), 6))
    for i, weight in enumerate(weights):
        found[:, i] = -GRAVITY * kinematics.link_jacobian(q, weight.link, weight.centre)[:, 2]
    return found


def torques(kinematics: Kinematics, q: FloatArray, weights: Sequence[Weight]) -> FloatArray:
    """Torque of all weights about each joint, balancing cylinders aside; shapes (n, 6) [rad] to (n, 6) [N m]."""
    masses = np.array([weight.mass for weight in weights])
    total: FloatArray = np.einsum("nwj,w->nj", torque_by_mass(kinematics, q, weights), masses)
    return total
