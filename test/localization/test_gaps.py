"""A strip that goes over into the background by light alone lies behind the face; one that is broken off may not."""

import cv2
import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Edges, PictureScene, Surface
from doormill_ros.units import MM
from support.views.render import render
from support.views.series import view_of

WIDTH, THICKNESS = 0.9, 0.05
OFFSET = DoorOffset(0.003, -0.002, 0.008)
SCENE = PictureScene(
    WIDTH,
    THICKNESS,
    OFFSET,
    face=Surface(0.6, mottle=0.01),
    background=Surface(0.3, mottle=0.01),
    edges=Edges(0.01 * MM),
)


def with_gap(camera, layout, over, dims_face=False):
    """A picture with a strip of 3 mm outside of the hinge edge that turns dark `over` some length along it [m]."""
    picture = render_picture(SCENE, 4)
    view = face_view(camera, layout, WIDTH, THICKNESS)
    u, v = np.meshgrid(np.arange(picture.shape[1]), np.arange(picture.shape[0]))
    y, z = view.points(np.stack([u.ravel(), v.ravel()], axis=-1).astype(float)).T - np.array(
        [[OFFSET.y], [OFFSET.z]]
    )
    cos, sin = np.cos(OFFSET.rotation), np.sin(OFFSET.rotation)
    across, along = cos * y + sin * z, cos * z - sin * y
    dark = np.clip((along + 0.5 * across - 9.0 * MM) / over + 0.5, 0.0, 1.0)
    where = np.clip(0.5 - across / view.pixel, 0.0, 1.0) * np.clip(
        0.5 + (across + 3.0 * MM) / view.pixel, 0.0, 1.0
    )
    if dims_face:
        where = np.maximum(where, across > 0.0)
    light = cv2.GaussianBlur((1.0 - 0.7 * dark * where).reshape(picture.shape), (0, 0), 1.0)
    return np.rint(picture * light).astype(np.uint8)


def test_a_gap_that_turns_dark_by_and_by_lies_behind_the_face(camera, layout):
    found = localize(with_gap(camera, layout, 12.0 * MM), camera, layout, WIDTH, THICKNESS).offset
    assert np.hypot(found.y - OFFSET.y, found.z - OFFSET.z) < 0.03 * MM


@pytest.mark.parametrize("kind", [{"over": 0.2 * MM}, {"over": 12.0 * MM, "dims_face": True}])
def test_one_with_a_border_or_with_the_light_of_the_face_may_be_a_part_of_it(kind, camera, layout):
    with pytest.raises(WrongEdge, match="may be the hinge edge"):
        localize(with_gap(camera, layout, **kind), camera, layout, WIDTH, THICKNESS)


@pytest.mark.parametrize(
    "number",
    [
        11,  # a gap before a rail
        272,  # the door's shadow on a shiny bench
        310,
        269,  # a seal cut off straight, and a groove across the face beside it
    ],
)
def test_what_a_traced_view_shows_beside_the_face_is_none_of_its_edges(number, camera, layout):
    view = view_of(number, 51)
    found = localize(render(view), camera, layout, view.place.width, view.told_thickness).offset
    assert np.hypot(found.y - view.offset.y, found.z - view.offset.z) < 0.1 * MM
