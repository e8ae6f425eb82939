"""What docs/world.md prints of a world that is as assumed."""

from __future__ import annotations

import numpy as np

from doormill_ros.simulation.world.world_file import CameraOfWorld, ClampOfWorld


def camera_moved() -> float:
    """Way and turn of the camera of which a world file says nothing."""
    return float(np.abs([CameraOfWorld().moved, CameraOfWorld().turned]).max())


def clamp_shift() -> float:
    """The same of the clamp."""
    return float(np.abs(ClampOfWorld().shift).max())
