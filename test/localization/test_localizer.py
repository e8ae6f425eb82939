"""The pose that comes out is the pose that went into the picture."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.overlay import draw_overlay
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Edges, PictureScene, Surface
from doormill_ros.units import DEG, MM


@pytest.mark.parametrize("thickness", [0.030, 0.100])
def test_pose_of_a_grained_door(thickness):
    offset = DoorOffset(0.006, -0.004, 0.02)
    scene = PictureScene(
        0.8, thickness, offset, face=Surface(0.6, mottle=0.03, grain=0.05), edges=Edges(2e-5)
    )
    picture = render_picture(scene, seed=1)
    found = localize(picture, load_camera(), load_layout(), 0.8, thickness)
    assert abs(found.offset.y - offset.y) < 0.02 * MM
    assert abs(found.offset.z - offset.z) < 0.02 * MM
    assert abs(found.offset.rotation - offset.rotation) < 0.02 * DEG
    np.testing.assert_allclose(found.T_base_door, load_layout().T_base_door(0.8, thickness, found.offset))
    assert draw_overlay(picture, found).shape == (1080, 1920, 3)
