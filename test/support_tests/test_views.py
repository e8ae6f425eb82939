"""The second world of pictures: its doors are where OpenCV's own projection puts them."""

import cv2
import numpy as np
import pytest
import yaml

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.resources import resource
from support.views.plainness import is_plain
from support.views.render import render
from support.views.series import FEATURES, view_of


def projected(view, points):
    """Pixels (n, 2) of points (n, 3) of the door [m], by OpenCV."""
    content = yaml.safe_load(resource("config/camera.yaml").read_text())
    mounting = content["mounting"]
    T_base_door = load_layout().T_base_door(view.place.width, view.place.thickness, view.offset)
    centre = np.array([mounting["x"], mounting["slider_y"] - view.place.width / 2.0, mounting["z"]])
    seen = points @ T_base_door[:3, :3].T + T_base_door[:3, 3] - centre
    R_camera_base = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    k, distortion = (
        np.array(content[part][key], dtype=float)
        for part, key in (("intrinsics", "k"), ("distortion", "coefficients"))
    )
    pixels, _ = cv2.projectPoints(seen @ R_camera_base.T, np.zeros(3), np.zeros(3), k, distortion)
    return pixels[:, 0]


def half_way(levels):
    """Where levels (2 n + 1,) about a step cross half of it, from the middle [places]."""
    inside, outside = levels[:6].mean(), levels[-6:].mean()
    share = (levels - outside) / (inside - outside)
    first = int(np.argmax(share < 0.5))
    return first - 1 + (share[first - 1] - 0.5) / (share[first - 1] - share[first]) - (len(levels) - 1) / 2


@pytest.mark.parametrize(
    "number", [8, 10, 12]
)  # of primer and board: grain along an edge moves half of its step
def test_a_bare_door_is_drawn_where_it_stands(number):
    view = view_of(number, 71, ())
    assert is_plain(view)
    picture = render(view).astype(float)
    places = np.zeros((400, 3))
    places[:, 2] = np.linspace(0.008, 0.055, 400)
    off = []
    for u, v in projected(view, places):
        row = picture[round(v)]
        at = u + np.arange(-12, 13)
        off.append(half_way(np.interp(at, np.arange(row.size), row)))
    assert len(off) == len(places)
    assert abs(np.median(off)) < 0.02
    places = places[:, [0, 2, 1]]
    off = [
        half_way(np.interp(v + np.arange(-12, 13), np.arange(picture.shape[0]), picture[:, round(u)]))
        for u, v in projected(view, places)
    ]
    assert abs(np.median(off)) < 0.02


def test_every_feature_can_be_drawn_and_again():
    assert len(FEATURES) > 50
    names = sorted(FEATURES)
    view = view_of(3, 72, tuple(names[::9]))
    assert np.array_equal(render(view), render(view_of(3, 72, tuple(names[::9]))))
    assert not np.array_equal(render(view), render(view_of(3, 72, ())))
