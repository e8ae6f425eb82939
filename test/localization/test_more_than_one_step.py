"""Edges that were read as one step and were not: pictures of a campaign whose poses had been accepted and wrong."""

import itertools

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import LocalizationError, WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, Strip, Surface
from doormill_ros.units import DEG, MM
from support.pictures.conditions import pictures

#: Of `bench_conditions.py 91 20001`: condition, number, what was wrong [mm or degrees], and what tells now.
ACCEPTED = (
    ("edge band 2 mm", 13, "1.548 mm", "two steps 1.0 mm apart may be the hinge edge"),
    ("edge band 0.4 to 1 mm", 57, "0.142 degrees", "1.3 times as soft as the other"),
    ("glossy streak along the edge", 36, "6.7 deviations", "1.6 times as soft as the other"),
    ("oak grain", 90, "0.232 mm", "up to there another runs 2.4 mm beside it"),
    ("second door behind", 79, "0.170 mm", "up to there another runs 2.1 mm beside it"),
    ("dark arris", 11, "0.362 mm", "outside of the corner lies a spot 0.26 mm wide"),
    ("dark arris", 48, "0.197 mm", "outside of the corner lies a spot 0.12 mm wide"),
    ("dark arris", 65, "0.348 mm", "outside of the corner lies a spot 0.29 mm wide"),
    ("dark arris", 68, "0.306 mm", "outside of the corner lies a spot 0.22 mm wide"),
    ("dark arris", 87, "0.172 mm", "outside of the corner lies a spot 0.18 mm wide"),
)
#: Of other seeds: condition, number, seed, how wrong they were.
FOUND = (
    ("edge band 0.4 to 1 mm", 66, 40013, "0.538 mm"),
    ("bright arris", 6, 777, "0.138 mm"),
    ("bright arris", 73, 40013, "5.2 deviations"),
    ("rail behind, along the edge", 48, 50021, "1.078 mm"),
)
FACE, BACK = Surface(0.55), Surface(0.2)


def picture_of(condition, number, seed):
    item = next(itertools.islice(pictures(condition, number + 1, seed), number, None))
    return item, render_picture(item.scene, item.seed)


def refused(item, picture, camera, layout):
    with pytest.raises(WrongEdge) as reason:
        localize(picture, camera, layout, item.scene.width, item.thickness, settings=item.settings)
    assert reason.value.data["marks"]
    return str(reason.value)


@pytest.mark.parametrize(("condition", "number", "was", "tells"), ACCEPTED, ids=lambda value: str(value))
def test_what_is_more_than_one_step_is_refused_and_shown(condition, number, was, tells, camera, layout):
    assert tells in refused(*picture_of(condition, number, 20001), camera, layout)


def test_a_band_nearly_as_dark_as_the_background_that_ends_with_the_face_is_refused(camera, layout):
    told = refused(*picture_of("edge band 2 mm", 78, 50021), camera, layout)  # 2.949 mm off before
    assert "two steps 2.9 mm apart may be the bottom edge" in told


@pytest.mark.parametrize(("condition", "number", "seed", "was"), FOUND, ids=lambda value: str(value))
def test_the_edge_is_found_beside_another_step(condition, number, seed, was, camera, layout):
    item, picture = picture_of(condition, number, seed)
    found = localize(picture, camera, layout, item.scene.width, item.thickness, settings=item.settings)
    true = item.scene.offset
    error = np.array(
        [found.offset.y - true.y, found.offset.z - true.z, found.offset.rotation - true.rotation]
    )
    assert np.hypot(*error[:2]) < 0.05 * MM
    assert error @ np.linalg.solve(found.covariance, error) < 3.0**2


def scene(turn: float, factor: float, width: float) -> PictureScene:
    """A door with a rim of that width [m] along both edges, its brightness times a factor, turned [degrees]."""
    rims = tuple(Strip(edge, -1.0, width, factor) for edge in ("hinge", "bottom"))
    strips = rims if width else ()
    return PictureScene(
        0.9, 0.04, DoorOffset(2.1 * MM, -1.6 * MM, turn * DEG), face=FACE, background=BACK, strips=strips
    )


@pytest.mark.parametrize("width", [0.16, 0.2, 0.3])
@pytest.mark.parametrize("turn", [-1.2, 0.4])
def test_a_rim_exactly_as_dark_as_the_background_shows_where_it_crosses_itself(turn, width, camera, layout):
    rimmed = scene(turn, BACK.brightness / FACE.brightness, width * MM)
    with pytest.raises(WrongEdge, match="outside of the corner"):
        localize(render_picture(rimmed, 3), camera, layout, rimmed.width, rimmed.thickness)


@pytest.mark.parametrize("turn", [-1.2, 0.0, 0.4])
def test_a_corner_without_a_rim_is_accepted_and_right(turn, camera, layout):
    plain = scene(turn, 1.0, 0.0)
    found = localize(render_picture(plain, 3), camera, layout, plain.width, plain.thickness).offset
    assert np.hypot(found.y - plain.offset.y, found.z - plain.offset.z) < 0.03 * MM


def test_a_spot_of_dirt_is_no_reason_to_refuse_a_door_of_which_it_covers_no_edge(camera, layout):
    """Far enough from the corner it is not looked at, however dark."""
    plain = scene(0.4, 1.0, 0.0)
    picture = render_picture(plain, 3)
    found = localize(picture, camera, layout, plain.width, plain.thickness)
    x, y = (round(float(v)) for v in found.corner)
    spotted = picture.copy()
    spotted[y + 14 : y + 18, x + 14 : x + 18] = 5
    spotted[y + 14 : y + 18, x - 18 : x - 14] = 5
    again = localize(spotted, camera, layout, plain.width, plain.thickness).offset
    assert np.hypot(again.y - found.offset.y, again.z - found.offset.z) < 0.01 * MM


def test_whatever_a_rim_is_like_no_door_is_accepted_and_wrong(camera, layout):
    """Rims from half as dark as the background to twice as bright, so wide that more than a pixel of them shows."""
    rng = np.random.default_rng(12)
    refused = 0
    for _ in range(16):
        factor = BACK.brightness / FACE.brightness * np.exp(rng.uniform(np.log(0.5), np.log(2.0)))
        rimmed = scene(float(rng.uniform(-1.5, 1.5)), float(factor), float(rng.uniform(0.16, 0.4)) * MM)
        try:
            found = localize(
                render_picture(rimmed, int(rng.integers(99))), camera, layout, rimmed.width, rimmed.thickness
            )
        except LocalizationError:
            refused += 1
            continue
        found, true = found.offset, rimmed.offset
        assert np.hypot(found.y - true.y, found.z - true.z) < 0.1 * MM
    assert refused < 16
