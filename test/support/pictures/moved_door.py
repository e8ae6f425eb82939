"""A door at known places before the cell's camera, rendered once in a session."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene

WIDTH, THICKNESS = 1.0, 0.04
EVERY = 30.0  #: time between two pictures [s]


@pytest.fixture(scope="session")
def photographed() -> tuple[list[DoorOffset], list[np.ndarray]]:
    """Pictures of a door at 12 known places, two at each, by the camera as it truly is."""
    cv2.setNumThreads(1)
    rng = np.random.default_rng(9)
    places = np.column_stack([rng.uniform(-0.008, 0.008, (12, 2)), rng.uniform(-0.025, 0.025, 12)])
    moved = [DoorOffset(*place) for place in np.tile(places, (2, 1))]
    return moved, [render_picture(PictureScene(WIDTH, THICKNESS, m), 300 + i) for i, m in enumerate(moved)]
