"""A dark arris that looks like softness is found in what all rows of an edge have in common, or the door is refused."""

from dataclasses import replace
from math import erf, sqrt

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.edge_points.blur import Spread, bin_places
from doormill_ros.localization.edge_points.texture import Variograms
from doormill_ros.localization.errors import LocalizationError, WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.rims.arris import Profile
from doormill_ros.localization.rims.rim import Rim
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import BackEdge, Edges, PictureScene, Sensor, Strip, Surface
from doormill_ros.units import MM
from support.pictures.corpus import corpus

PLACE, PIXEL, STEP = bin_places(47), 1e-4, 100.0
CALM = Variograms(np.full(25, 0.1), np.zeros(25))
SCENE = PictureScene(
    0.9,
    0.05,
    DoorOffset(0.003, -0.002, 0.011),
    face=Surface(0.6, mottle=0.015, grain=0.01),
    background=Surface(0.2, mottle=0.03, mottle_size=4 * MM),
    edges=Edges(0.015 * MM),
    sensor=Sensor(blur=0.9),
)


def soft(at, blur):
    """A step at `at` seen with a Gaussian point spread and the pixel's own width."""
    sigma = sqrt(blur**2 + 1 / 12)
    return np.array([0.5 * (1 + erf((x - at) / sigma / sqrt(2))) for x in PLACE])


def profile(shape, blur, textures=(CALM, CALM)):
    """The shape as 800 rows of an edge show it."""
    noise = 1e-3
    seen = shape + noise * np.random.default_rng(2).standard_normal(PLACE.size)
    return Profile(Spread(blur, 0.005, noise, seen, np.full(PLACE.size, noise), PLACE), STEP, *textures)


def dark(width, level, blur, outer):
    """A rim `width` px wide with its outer border at `outer`, `level` of the step above the background."""
    return level * soft(outer, blur) + (1 - level) * soft(outer - width, blur)


@pytest.mark.parametrize(
    ("width", "level", "blur", "seems"),
    [(1.4, 0.2, 0.9, 1.05), (1.6, 0.33, 0.8, 1.1), (2.8, -0.03, 1.0, 0.95)],
)
def test_a_rim_that_looks_like_softness_is_found(width, level, blur, seems):
    rim = profile(dark(width, level, blur, 0.9 * width), seems).find(PIXEL)
    assert rim is not None
    assert rim.shift == pytest.approx(0.9 * width, abs=max(3 * rim.deviation, 0.1))
    assert rim.width == pytest.approx(width, abs=max(3 * rim.deviation, 0.3))


def test_what_spreads_an_edge_evenly_is_no_rim():
    nodes = np.linspace(-1, 1, 201)[1:-1]
    disc = np.sqrt(1 - nodes**2) / np.sqrt(1 - nodes**2).sum()
    lens = profile(soft(0.1, 1.1), 1.1)
    defocused = profile(sum(w * soft(2.0 * n, 0.8) for n, w in zip(nodes, disc, strict=True)), 1.35)
    fibrous = profile(np.mean([soft(1.5 * n, 0.9) for n in nodes], axis=0), 1.25)
    for one in (lens, defocused, fibrous):
        assert one.find(PIXEL) is None


def test_streaks_beside_the_edge_are_no_rim():
    place = np.arange(25)
    streaky = Variograms(np.full(25, 10.0), 8.0 * (1 - np.exp(-0.5 * (place / 2.0) ** 2)))
    shape = soft(0.0, 1.0) + 0.02 * np.exp(-0.5 * ((PLACE + 2.5) / 1.2) ** 2)
    assert profile(shape, 1.0).odd()
    assert not profile(shape, 1.0, (streaky, CALM)).odd()


def rim_of(level, width=3.0):
    return Rim(shift=2.5, deviation=0.05, width=width, brightness=level - 1.0, blur=1.0, misfit=0.002)


def test_the_rim_of_the_other_edge_is_found_placed_or_the_door_refused():
    found = profile(dark(3.0, 0.1, 1.0, 1.7), 1.1).like("hinge", rim_of(0.1), PIXEL)
    assert found.shift == pytest.approx(1.7, abs=max(3 * found.deviation, 0.1))
    with pytest.raises(WrongEdge, match=r"0\.30 mm lies along one edge and none along the hinge edge"):
        profile(soft(0.0, 1.0), 1.0).like("hinge", rim_of(0.3), PIXEL)
    with pytest.raises(WrongEdge, match="does not tell whether one lies along it"):
        profile(soft(0.0, 1.0), 1.0).like("hinge", rim_of(0.01), PIXEL)


def off(scene, seed, camera, layout):
    """How far the pose found is from the true one [m]."""
    found = localize(render_picture(scene, seed), camera, layout, scene.width, scene.thickness).offset
    return np.hypot(found.y - scene.offset.y, found.z - scene.offset.z)


@pytest.mark.parametrize(("width", "factor"), [(0.14, 0.4), (0.12, 0.45)])
def test_a_narrow_arris_is_seen_in_a_picture(width, factor, camera, layout):
    strips = tuple(Strip(edge, -1.0, width * MM, factor) for edge in ("hinge", "bottom"))
    assert off(replace(SCENE, strips=strips), 6, camera, layout) < 0.03 * MM


def test_an_arris_a_little_darker_than_the_background_is_refused(camera, layout):
    strips = tuple(Strip(edge, -1.0, 0.2 * MM, 0.3) for edge in ("hinge", "bottom"))
    with pytest.raises(LocalizationError, match="rim"):
        off(replace(SCENE, strips=strips), 6, camera, layout)
    assert off(SCENE, 6, camera, layout) < 0.03 * MM


def test_the_brim_of_something_behind_one_edge_is_not_taken_for_an_arris(camera, layout):
    behind = BackEdge(0.0, 9.5 * MM, 60 * MM, 0.84)
    with pytest.raises(WrongEdge, match="along one edge and none along the hinge edge"):
        off(replace(SCENE, back_edge=behind), 6, camera, layout)


def test_a_bevel_round_the_corner_is_not_face_along_one_edge_and_back_along_the_other(camera, layout):
    bevelled = corpus(105, 77)[104]
    with pytest.raises(WrongEdge, match=r"two steps 2\.\d mm apart"):
        off(bevelled.scene, bevelled.seed, camera, layout)
