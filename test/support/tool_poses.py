"""Nominal tool poses at points of a feature."""

from __future__ import annotations

import numpy as np

from doormill_ros.frames import transform
from doormill_ros.recipes.door import R_FEATURE_TOOL, DoorSize
from doormill_ros.recipes.features.base import Feature


def T_door_tool(
    feature: Feature, door: DoorSize, x: float = 0.0, y: float = 0.0, depth: float = 0.0
) -> np.ndarray:
    """Tool in the door frame at a point of the feature [m], shape (4, 4)."""
    return feature.T_door_feature(door) @ transform(R_FEATURE_TOOL, np.array([x, y, depth]))
