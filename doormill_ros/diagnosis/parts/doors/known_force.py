"""How well the force is known that milled a feature, as the path generator took it to be."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.correction.cutting_force import COEFFICIENTS, wrench_std
from doormill_ros.frames import rotate_wrench
from doormill_ros.recipes.door import Material
from doormill_ros.recipes.features.base import Feature


def force_spread(
    feature: Feature, material: Material, wrench: FloatArray, R_base_tool: FloatArray
) -> FloatArray:
    """Standard deviations of wrenches on the tool, as in `Loads`, shape (n, 6, 6) [N, N m].

    Args:
        feature: That was milled.
        material: Of the door.
        wrench: Assumed, base axes, shape (n, 6) [N, N m].
        R_base_tool: Shape (n, 3, 3).
    """
    of_tool = rotate_wrench(np.swapaxes(R_base_tool, 1, 2), wrench)
    if feature.computes_force:
        std = wrench_std(of_tool, COEFFICIENTS[material])
    else:
        std = feature.std_of(of_tool)
    return rotate_wrench(R_base_tool[:, None], std[:, :, None] * np.eye(6))
