"""Edges that bend: the bend is measured, its uncertainty is honest, and a door whose edge shows one is refused."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import BowedEdge
from doormill_ros.localization.lines.fit import fit_line
from doormill_ros.localization.lines.straightness import check_straight
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.settings import load_settings
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Edges, PictureScene, Surface
from doormill_ros.units import MM

ALONG = np.arange(0.0, 0.13, 1.0e-4)
SETTINGS = load_settings()


def drawn(edge):
    """Where an edge is in the picture."""
    return np.zeros((2, 2))


def sawn(rng, bend=0.0, rough=0.015 * MM):
    """A line through an edge that wanders over 2 mm and is bent."""
    kernel = np.exp(-0.5 * (np.arange(-40, 41) / 10.0) ** 2)
    wander = np.convolve(
        rng.standard_normal(ALONG.size + 80), kernel / np.sqrt(np.sum(kernel**2)), mode="valid"
    )
    across = rough * wander + bend * (ALONG - 0.065) ** 2 + 2e-6 * rng.standard_normal(ALONG.size)
    return fit_line(ALONG, across, np.ones(ALONG.size, dtype=bool), (0.0, 0.0))


def test_a_bend_is_measured():
    found = [sawn(np.random.default_rng(seed), bend=-0.03) for seed in range(40)]
    bends = np.array([line.bend for line in found])
    assert np.mean(bends) == pytest.approx(-0.03, abs=0.001)
    scores = (bends + 0.03) / np.sqrt([line.bend_variance for line in found])
    assert 0.6 < np.sqrt(np.mean(scores**2)) < 1.3


def test_straight_edges_are_not_called_bowed():
    for seed in range(60):
        check_straight({"bottom": sawn(np.random.default_rng(100 + seed))}, drawn, SETTINGS)


def test_a_bowed_edge_is_refused_with_its_size_and_place():
    with pytest.raises(BowedEdge, match=r"bottom edge is bowed: over 400 mm .* by 0\.[67]\d mm") as refused:
        check_straight({"bottom": sawn(np.random.default_rng(1), bend=0.0165)}, drawn, SETTINGS)
    assert refused.value.data["edge"] == "bottom"
    tolerant = replace(SETTINGS, straightness_limit=1.0 * MM)
    check_straight({"bottom": sawn(np.random.default_rng(1), bend=0.0165)}, drawn, tolerant)


def test_a_picture_of_a_bowed_door_is_refused(camera, layout):
    edges = Edges(0.008 * MM, bow=(0.0, 0.5 * MM))
    scene = PictureScene(0.8, 0.04, DoorOffset(0.002, 0.001, 0.01), face=Surface(0.6), edges=edges)
    with pytest.raises(BowedEdge) as refused:
        localize(render_picture(scene, 4), camera, layout, scene.width, scene.thickness)
    assert refused.value.data["marks"]
    straight = replace(scene, edges=Edges(0.008 * MM))
    localize(render_picture(straight, 4), camera, layout, scene.width, scene.thickness)


def test_a_cell_of_bowed_doors_mills_only_those_whose_edges_show_that_they_are_straight():
    bowed = replace(SETTINGS, straightness_deviation=0.17 * MM)
    rough, smooth = (sawn(np.random.default_rng(3), rough=rms) for rms in (0.05 * MM, 0.001 * MM))
    check_straight({"bottom": rough}, drawn, SETTINGS)
    check_straight({"bottom": smooth}, drawn, bowed)
    with pytest.raises(
        BowedEdge, match=r"doors of this cell are bowed by 0\.17 mm .* leaves 0\.1\d mm of it open"
    ):
        check_straight({"bottom": rough}, drawn, bowed)
    bent = sawn(np.random.default_rng(3), bend=0.0075, rough=0.001 * MM)
    with pytest.raises(BowedEdge, match=r"leaves 0\.(29|30) mm of it open"):
        check_straight({"bottom": bent}, drawn, bowed)


def test_a_sawn_edge_leaves_a_bow_open_as_independent_points_would():
    """The equation of `straightness`; a line that gives less weight to the largest waves bends a little less."""
    length, over, wander, reach = float(ALONG[-1]), 0.4, 0.015 * MM, 2.0 * MM
    rises = [sawn(np.random.default_rng(500 + seed)).bend * over**2 / 4 for seed in range(80)]
    stated = wander * over**2 * np.sqrt(11.25 * np.sqrt(np.pi) * reach / length**5)
    assert 0.6 * stated < np.std(rises) < 1.1 * stated
