"""The drawn door is found where it was drawn, so that a rehearsal goes all the way."""

from __future__ import annotations

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.rehearsal import FACE, drawn_door
from doormill_ros.localization.view import face_view


def test_the_drawn_door_is_found_where_the_nominal_one_stands() -> None:
    camera, layout = load_camera(), load_layout()
    picture = drawn_door(camera, layout)
    assert picture.shape == camera.size[::-1]
    found = localize(picture, camera, layout, FACE.width, FACE.thickness)
    pixel = face_view(camera, layout, FACE.width, FACE.thickness).pixel
    # A drawing is no finer than a pixel; over the shorter edge, 60 mm, it turns by as much.
    assert np.hypot(found.offset.y, found.offset.z) < 1.5 * pixel
    assert abs(found.offset.rotation) < 1.5 * pixel / 0.06
    assert found.inlier_share > 0.9
