"""The picture simulator does what its scene says."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.camera import load_camera
from doormill_ros.simulation.picture.outline import EdgeProfile, wander
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Chip, Edges, PictureScene, Sensor, Strip, Surface
from doormill_ros.units import MM
from support.pictures.conditions import CONDITIONS, pictures
from support.pictures.corpus import HARD, corpus
from support.pictures.expected import expected_picture


@pytest.fixture(scope="module")
def scene():
    return PictureScene(0.8, 0.05, DoorOffset(0.002, 0.003, 0.01), sensor=Sensor(blur=1.3))


def test_equal_seeds_give_equal_pictures(scene):
    scene = replace(scene, face=Surface(0.6, grain=0.05, mottle=0.02), edges=Edges(0.02 * MM))
    first, same, other = (render_picture(scene, seed) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, same)
    assert np.mean(first != other) > 0.3


def test_roughness_has_its_rms_and_correlation_length():
    rng = np.random.default_rng(3)
    step, correlation = 0.05 * MM, 2 * MM
    lines = np.array([wander(rng, 0.02 * MM, correlation, 4000, step) for _ in range(60)])
    assert np.sqrt(np.mean(lines**2)) == pytest.approx(0.02 * MM, rel=0.05)
    lag = round(correlation / step)
    share = np.mean(lines[:, lag:] * lines[:, :-lag]) / np.mean(lines**2)
    assert share == pytest.approx(np.exp(-1), abs=0.06)


def test_a_chip_bites_where_it_is():
    outline = EdgeProfile(
        np.random.default_rng(1), Edges(chips=(Chip("hinge", 0.03, 2 * MM, 0.5 * MM),)), "hinge"
    )
    along = np.array([[0.025, 0.03, 0.035]], dtype=np.float32)
    before, in_it, after = outline(along)[0]
    assert before == pytest.approx(0, abs=1e-6)
    assert after == pytest.approx(0, abs=1e-6)
    assert 0.1 * MM < in_it < 0.9 * MM


def test_a_bowed_edge_leaves_its_line_in_the_middle():
    outline = EdgeProfile(np.random.default_rng(1), Edges(bow=(0.3 * MM, -0.2 * MM), bow_length=0.2), "hinge")
    start, middle, quarter = outline(np.array([[-0.02, 0.05, 0.1]], dtype=np.float32))[0]
    assert middle == pytest.approx(0.3 * MM, rel=1e-3)
    assert quarter == pytest.approx(0.3 * MM * (1 - 0.5**2), rel=1e-3)
    assert start == pytest.approx(0.3 * MM * (1 - 0.7**2), rel=1e-3)


def test_a_strip_takes_its_share_of_the_face(scene):
    """The light that a darker strip takes away is its width times its shade, pixel row by pixel row."""
    strip = Strip("hinge", 1.0 * MM, 6.0 * MM, 0.8)
    lost = expected_picture(scene, 0) - expected_picture(replace(scene, strips=(strip,)), 0)
    per_pixel = scene.distance / scene.camera.matrix[0, 0]
    for row in (100, 350, 600):
        # Rows cross the strip at an angle to the door, and at the size of a pixel behind a lens.
        width = lost[row].sum() / (0.2 * 0.65 * 255) * per_pixel
        assert width == pytest.approx(5.0 * MM / np.cos(0.01), rel=0.04)


def test_every_condition_is_seeded_and_changes_the_picture(scene):
    assert len(CONDITIONS) > 25
    for name in CONDITIONS:
        (one,), (same,) = pictures(name, 1), pictures(name, 1)
        assert (one.seed, one.scene.offset) == (same.seed, same.scene.offset)
        # With marks or beams beside it, it is the plain one in another cell, a thicker door is one of another recipe.
        same_door = ("plain", "marks beside the door", "beams beside the camera")
        if name not in same_door and "thicker" not in name:
            changed = CONDITIONS[name].change(scene, np.random.default_rng(1))
            assert repr(changed) != repr(scene), name


def test_edge_lies_where_the_camera_must_see_it(scene):
    """A pixel row's light is face plus background in the ratio in which the edge divides it."""
    expected = expected_picture(scene, 0)
    camera = load_camera()
    for row in (100, 350, 600):
        values = expected[row]
        dark, bright = 0.18 * 255, 0.65 * 255
        found = np.sum((values - dark) / (bright - dark)) - 0.5  # pixels of face in the row
        along = np.linspace(-0.01, 0.1, 4000)
        T_base_door = scene.layout.T_base_door(scene.width, scene.thickness, scene.offset)
        points = T_base_door[:3, 3] + along[:, None] * T_base_door[:3, 2]
        u, v = camera.project(points, scene.width).T
        assert found == pytest.approx(np.interp(row, v[::-1], u[::-1]), abs=0.01)


def test_blur_widens_the_edge_as_stated(scene):
    expected = expected_picture(scene, 0)
    slope = -np.diff(expected[300])
    slope /= slope.sum()
    place = np.arange(slope.size)
    middle = np.sum(place * slope)
    spread = np.sqrt(np.sum((place - middle) ** 2 * slope))
    # Differences of neighbouring pixels add another pixel's width to that of the pixel itself.
    assert spread == pytest.approx(np.sqrt(1.3**2 + 2.0 / 12.0), rel=0.03)


def test_noise_has_the_variance_of_read_noise_and_photons(scene):
    scene = replace(scene, sensor=Sensor(blur=1.3, read_noise=1.5, gain=0.05))
    flat = expected_picture(scene, 0)[100:400, 100:400]
    noise = render_picture(scene, 0)[100:400, 100:400] - flat
    assert np.var(noise) == pytest.approx(1.5**2 + 0.05 * flat.mean() + 1.0 / 12.0, rel=0.03)
    assert abs(noise.mean()) < 0.05


def test_corpus_is_seeded_and_holds_every_kind():
    one, two = corpus(70, 9), corpus(70, 9)
    assert [c.seed for c in one] == [c.seed for c in two]
    assert [c.scene.offset for c in one] == [c.scene.offset for c in two]
    assert {c.label for c in one} == {"workshop", *HARD}
    assert all(c.acceptable == (c.label == "workshop") for c in one)
    good = [c.scene for c in one if c.acceptable]
    assert any(s.back_edge for s in good)
    assert any(s.edges.chips for s in good)
    assert any(s.sensor.defocus for s in good)
    assert any(s.light.shadows for s in good)
    assert all(s.edges.roughness == 0.02 * MM for s in good)
