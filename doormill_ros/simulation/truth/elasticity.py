"""How joints and links of the simulated truth give way, one load case a row."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.truth.effects import Physics


def joint_give(
    physics: Physics, k: int, q: FloatArray, torque: FloatArray, direction: FloatArray
) -> FloatArray:
    """Angle by which the load turns joint k.

    A joint whose last motion went along the load is not pre-loaded: the load first pushes it
    through its backlash. One that came from the other side lies against the flank already
    (thesis section 3.3).

    Args:
        physics: Sizes of the effects.
        k: Joint, 0 to 5.
        q: Angle of the joint, shape (n,) [rad].
        torque: Torque of the load about the joint axis, shape (n,) [N m].
        direction: Last motion of the joint, -1, 0 or +1, shape (n,); 0 counts as pre-loaded.

    Returns:
        Shape (n,) [rad].
    """
    along = direction * torque > 0.0
    against = ~along
    size = np.abs(torque)
    felt = np.maximum(size - physics.dead_zone[k] - np.where(against, physics.friction[k], 0.0), 0.0)
    spring = felt / (physics.stiffness[k] * (1.0 + physics.hardening[k] * size))
    if physics.crossing[k] > 0.0:
        crossed = np.minimum(size / physics.crossing[k], 1.0)
    else:
        crossed = np.where(size > 0.0, 1.0, 0.0)
    amplitude, order = physics.ripple[k]
    ripple = amplitude * np.sin(order * q) * torque
    give: FloatArray = np.sign(torque) * (spring + np.where(along, physics.gap[k] * crossed, 0.0)) + ripple
    return give


def cantilever(
    bending: float, torsion: float, tip: FloatArray, force: FloatArray, moment: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Displacement and rotation at the tip of a straight clamped beam (Euler-Bernoulli).

    Args:
        bending: 1 / EI [1 / (N m^2)].
        torsion: 1 / GJ [1 / (N m^2)].
        tip: Root to tip, shape (n, 3) [m].
        force: Force at the tip, shape (n, 3) [N].
        moment: Moment at the tip, shape (n, 3) [N m].

    Returns:
        Displacement (n, 3) [m] and rotation vector (n, 3) [rad]; zero for a beam without length.
    """
    length = np.linalg.norm(tip, axis=1, keepdims=True)
    axis = tip / np.where(length > 0.0, length, 1.0)
    along = np.sum(moment * axis, axis=1, keepdims=True) * axis
    across_moment = moment - along
    across_force = force - np.sum(force * axis, axis=1, keepdims=True) * axis
    displacement = bending * (
        across_force * length**3 / 3.0 + np.cross(across_moment, axis) * length**2 / 2.0
    )
    rotation = bending * (np.cross(axis, across_force) * length**2 / 2.0 + across_moment * length)
    return displacement, rotation + torsion * along * length
