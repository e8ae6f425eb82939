"""Where two steps may be the edge, both are named and drawn; what proves one of them decides."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.overlay import draw_refusal
from doormill_ros.localization.settings import load_settings
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import BackEdge, Edges, PictureScene, Surface
from doormill_ros.units import DEG, MM

WIDTH, THICKNESS = 0.9, 0.05
OFFSET = DoorOffset(0.003, -0.002, 0.008)
BEVELLED = PictureScene(
    WIDTH,
    THICKNESS,
    OFFSET,
    face=Surface(0.6, mottle=0.015),
    background=Surface(0.15),
    edges=Edges(0.015 * MM),
    back_edge=BackEdge(3.0 * MM, 0.0, 1.0 * MM, 0.6),
)


@pytest.fixture(scope="module")
def plain():
    scene = PictureScene(WIDTH, THICKNESS, OFFSET, face=Surface(0.6, mottle=0.01), edges=Edges(0.01 * MM))
    return render_picture(scene, 4)


def banded(picture, camera, layout, factor, below=0.0):
    """The picture with a strip 3 mm wide of another brightness inside the hinge edge, from `below` the bottom edge."""
    view = face_view(camera, layout, WIDTH, THICKNESS)
    pose = np.array([OFFSET.y, OFFSET.z, OFFSET.rotation])
    y_axis = np.array([np.cos(pose[2]), np.sin(pose[2])])
    edge = view.line("hinge", pose, np.array([-below, 0.12]))
    outline = view.pixels(np.concatenate([edge, edge[::-1] + 3 * MM * y_axis]))
    mask = np.zeros(picture.shape, np.float32)
    cv2.fillPoly(mask, [np.rint(outline * 16).astype(np.int32)], 1.0, cv2.LINE_AA, 4)
    mask = cv2.GaussianBlur(mask, (0, 0), 1.0)
    return np.clip(picture * (1 + (factor - 1) * mask), 0, 255).astype(np.uint8)


def off(found):
    """Distance of a pose from the truth [m]."""
    return np.hypot(found.offset.y - OFFSET.y, found.offset.z - OFFSET.z)


def test_a_band_as_bright_as_the_face_belongs_to_it(plain, camera, layout):
    for factor in (0.9, 1.15):
        found = localize(banded(plain, camera, layout, factor), camera, layout, WIDTH, THICKNESS)
        assert off(found) < 0.05 * MM


def test_a_shadow_that_goes_on_over_the_background_is_no_edge(plain, camera, layout):
    view = face_view(camera, layout, WIDTH, THICKNESS)
    pose = np.array([OFFSET.y, OFFSET.z, OFFSET.rotation])
    border = view.line("hinge", pose, np.array([-0.03, 0.12])) + np.array([3 * MM, 0.0])
    start = view.pixels(border)
    u = np.interp(np.arange(plain.shape[0]), start[::-1, 1], start[::-1, 0])
    shade = np.where(np.arange(plain.shape[1]) > u[:, None], np.float32(0.45), np.float32(1.0))
    shaded = plain * cv2.GaussianBlur(shade, (0, 0), 1.0)
    found = localize(np.rint(shaded).astype(np.uint8), camera, layout, WIDTH, THICKNESS)
    assert off(found) < 0.05 * MM


def test_a_dark_band_that_ends_with_the_face_belongs_to_it(plain, camera, layout):
    found = localize(banded(plain, camera, layout, 0.6), camera, layout, WIDTH, THICKNESS)
    assert off(found) < 0.05 * MM


def test_a_dark_strip_that_may_be_a_bevel_is_refused_and_both_steps_are_drawn(camera, layout):
    picture = render_picture(BEVELLED, 6)
    with pytest.raises(WrongEdge, match=r"two steps \d\.\d mm apart may be the hinge edge") as refusal:
        localize(picture, camera, layout, WIDTH, THICKNESS)
    (inner, first), (outer, second) = refusal.value.data["marks"]
    assert (inner, outer) == ("inner", "outer")
    apart = 2.7 * MM / face_view(camera, layout, WIDTH, THICKNESS).pixel
    assert abs(second[:, 0] - first[:, 0]) == pytest.approx(np.full(2, apart), abs=0.2 * apart)
    drawn = draw_refusal(picture, refusal.value)
    changed = np.any(drawn != cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB), axis=2)
    for line in (first, second):
        u, v = np.rint(line.mean(axis=0)).astype(int)
        assert changed[v - 2 : v + 3, u - 2 : u + 3].any()


def test_an_angle_within_its_tolerance_turns_only_the_bottom_edge(camera, layout):
    edges = Edges(0.01 * MM, squareness=0.1 * DEG)
    scene = PictureScene(WIDTH, THICKNESS, OFFSET, face=Surface(0.6, mottle=0.01), edges=edges)
    picture = render_picture(scene, 4)
    found = localize(picture, camera, layout, WIDTH, THICKNESS)
    assert abs(found.offset.rotation - OFFSET.rotation) < 4 * found.deviations[2]
    strict = replace(load_settings(), squareness_limit=0.0)
    with pytest.raises(WrongEdge, match="out of square"):
        localize(picture, camera, layout, WIDTH, THICKNESS, settings=strict)


def test_parts_of_the_covariance_are_kept_apart(plain, camera, layout):
    settings = load_settings()
    found = localize(plain, camera, layout, WIDTH, THICKNESS, settings=settings)
    own = localize(plain, camera, layout, WIDTH, THICKNESS, settings=settings.picture_only())
    np.testing.assert_array_equal(found.parts.scatter, own.covariance)
    lensless = localize(
        plain, camera, layout, WIDTH, THICKNESS, settings=replace(settings, lens_deviation=0.0)
    )
    more = np.sqrt(np.diag(found.parts.calibration - lensless.parts.calibration)[:2])
    # A focal length off by a share moves the corner by that share of its distance from the optical axis.
    corner = layout.T_base_door(WIDTH, THICKNESS, OFFSET)[1:3, 3]
    axis = camera.T_base_camera(WIDTH)[1:3, 3]
    np.testing.assert_allclose(more, settings.lens_deviation * np.abs(corner - axis), rtol=0.01)
    assert found.deviations[0] > 10 * np.sqrt(own.covariance[0, 0])
