"""The overlay marks what was found, where it was found."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.overlay import draw_overlay
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Chip, Edges, PictureScene
from doormill_ros.units import MM


@pytest.fixture(scope="module")
def drawn(camera, layout):
    edges = Edges(0.02 * MM, chips=(Chip("bottom", 0.06, 6 * MM, 1.5 * MM),))
    scene = PictureScene(0.8, 0.05, DoorOffset(0.002, 0.001, 0.01), edges=edges)
    picture = render_picture(scene, 1)
    before = picture.copy()
    found = localize(picture, camera, layout, 0.8, 0.05)
    out = draw_overlay(picture, found)
    np.testing.assert_array_equal(picture, before)
    return picture, found, out


def colours(out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Masks of clearly red and clearly green pixels."""
    r, g, b = (out[..., i].astype(int) for i in range(3))
    return (r > g + 90) & (r > b + 90), (g > r + 60) & (g > b + 60)


def test_it_is_a_colour_picture_of_the_same_size(drawn):
    picture, _, out = drawn
    assert out.dtype == np.uint8
    assert out.shape == (*picture.shape, 3)


def test_inliers_are_green_along_both_edges_and_the_chip_is_red(drawn):
    _, found, out = drawn
    red, green = colours(out)
    assert len(found.edges) == 2
    for edge in found.edges:
        points = edge.pixels[edge.inlier][200:-200]
        u, v = np.rint(points).astype(int).T
        near = [green[y - 6 : y + 7, x - 6 : x + 7].any() for x, y in zip(u, v, strict=True)]
        assert np.mean(near) > 0.9, edge.name
    bottom = found.edges[1]
    chip = bottom.pixels[~bottom.inlier].mean(axis=0)
    where = np.argwhere(red)
    assert len(where) > 50
    assert np.min(np.hypot(*(where - chip[::-1]).T)) < 15


def test_the_corner_is_where_the_lines_start(drawn):
    _, found, out = drawn
    assert len(found.edges) == 2
    for edge in found.edges:
        np.testing.assert_allclose(edge.line[0], found.corner, atol=1e-6)
    u, v = np.rint(found.corner).astype(int)
    assert out[v, u].min() > 200
