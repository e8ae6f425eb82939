"""Texture that goes on across a line, on the plane of the face, tells that the line is drawn on it."""

import numpy as np
import pytest

from doormill_ros.localization.localizer import localize
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.grain import goes_on
from doormill_ros.localization.search.shade import Surfaces
from doormill_ros.localization.view import EDGES, HINGE, face_view
from doormill_ros.units import DEG, MM
from support.views.render import render
from support.views.series import view_of

WIDTH, THICKNESS = 0.9, 0.05
INNER, OUTER = 6.0 * MM, 1.0 * MM
LINES = [EdgeLine(INNER, 0.0, 20.0), EdgeLine(OUTER, 0.0, 90.0)]
PITCH = 0.05 * MM


def grain(seed, count=6000):
    """Grain across an edge at places PITCH apart, shape (count,)."""
    noise = np.random.default_rng(seed).normal(0.0, 1.0, count)
    fine = np.convolve(noise, np.hanning(9), "same")
    return 1.0 + 0.05 * fine / fine.std()


@pytest.fixture(scope="module")
def plane(camera, layout):
    """The view, and y and z of its pixels on the plane of the face [m], shape (2, n)."""
    view = face_view(camera, layout, WIDTH, THICKNESS)
    u, v = np.meshgrid(np.arange(camera.size[0]), np.arange(camera.size[1]))
    return view, view.points(np.stack([u.ravel(), v.ravel()], axis=-1).astype(float)).T


def seen(plane, edge, slant=0.0, behind=0.0, strip_seed=1, over_all=None):
    """A face with grain, a darker strip along its edge that lies so deep per width, or so far behind, and no more.

    `over_all` is the seed of what lies over all of it, the background as well.
    """
    view, (y, z) = plane
    along, across = (z, y) if edge == HINGE else (y, z)
    axis = -view.distance * view.sight(np.zeros(2))[1 if edge == HINGE else 0]
    depth = np.where(across < INNER, behind + slant * (INNER - across), 0.0)
    place = axis + (along - axis) * (1.0 + depth / view.distance)
    at = np.clip(np.rint((place + 0.1) / PITCH).astype(int), 0, 5999)
    face, strip = grain(1)[at], 0.8 * grain(strip_seed)[at]
    light = np.where(across > INNER, face, np.where(across > OUTER, strip, 0.2))
    if over_all is not None:
        light *= grain(over_all)[np.clip(np.rint((along + 0.1) / PITCH).astype(int), 0, 5999)]
    noise = np.random.default_rng(9).normal(0.0, 1.0, light.size)
    picture = np.clip(np.rint(130.0 * light + noise), 0, 255).astype(np.uint8).reshape(view.camera.size[::-1])
    return goes_on(Surfaces(picture, view), edge, LINES, 0, OUTER)


@pytest.mark.parametrize("edge", EDGES)
def test_the_grain_of_the_face_goes_on_in_a_strip_on_it(edge, plane):
    assert seen(plane, edge)


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize(
    "other",
    [
        {"strip_seed": 2},
        {"behind": 15.0 * MM},
        {"slant": 0.5},
        {"slant": 1.0},
        {"slant": 2.0},
        {"strip_seed": 2, "over_all": 3},
    ],
    ids=["other grain", "a lip of the same", "a flat bevel", "a bevel", "a steep bevel", "shadows"],
)
def test_it_does_not_in_what_lies_behind(edge, other, plane):
    assert not seen(plane, edge, **other)


@pytest.mark.parametrize(
    ("number", "seed"),
    [
        (23, 51),  # film, a little askew
        (316, 51),  # film
        (225, 51),  # film, a lipping below it
        (78, 51),  # a pencil line
        (240, 51),  # grooves beside an edge band
    ],
)
def test_a_door_whose_grain_goes_on_to_its_edge_is_found(number, seed, camera, layout):
    view = view_of(number, seed)
    found = localize(render(view), camera, layout, view.place.width, view.told_thickness).offset
    assert np.hypot(found.y - view.offset.y, found.z - view.offset.z) < 0.1 * MM
    assert abs(found.rotation - view.offset.rotation) < 0.1 * DEG
