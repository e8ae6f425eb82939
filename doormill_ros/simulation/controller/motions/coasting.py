"""How an arm comes to rest when its drives lose their power.

Until the brakes hold the axes go on as they went; then each brake stops its axis alone, so that the tool leaves its
path (stop category 0: "uncontrolled", ABB 3HAC021313, 1.2.5.2). The times are the limits' [?].
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.motions.limits import ControllerLimits

#: Share of `brake_ramp` that each axis needs: no two brakes are alike [?].
SHARES = np.array([1.0, 1.25, 1.1, 0.8, 0.9, 0.75])
#: Time between samples [s].
STEP = 0.005


def coast(
    q: FloatArray, velocity: FloatArray, max_velocity: FloatArray, limits: ControllerLimits
) -> tuple[FloatArray, FloatArray]:
    """Times (n,) [s] and joint angles (n, 6) [rad] until the arm stands.

    Args:
        q: Joint angles at the loss of power, shape (6,) [rad].
        velocity: Joint speeds then, shape (6,) [rad/s].
        max_velocity: Largest joint speeds, shape (6,) [rad/s].
        limits: Times of the brakes.
    """
    ramp = np.maximum(limits.brake_ramp * SHARES * np.abs(velocity) / max_velocity, 1e-6)  # (6,)
    end = limits.brake_delay + float(ramp.max())
    time = np.linspace(0.0, end, int(np.ceil(end / STEP)) + 1)
    braking = np.clip(time[:, None] - limits.brake_delay, 0.0, ramp)  # (n, 6)
    free = np.minimum(time, limits.brake_delay)[:, None]
    return time, q + velocity * (free + braking - braking**2 / (2.0 * ramp))
