"""Dark bands and bevels a few pixels wide: on the face or behind it, told by what happens where they cross."""

from contextlib import suppress
from dataclasses import replace
from itertools import chain, product

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.view import EDGES
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import BackEdge, Edges, PictureScene, Sensor, Strip, Surface
from doormill_ros.units import MM

WIDTH, THICKNESS = 0.9, 0.05
SCENE = PictureScene(
    WIDTH,
    THICKNESS,
    DoorOffset(0.003, -0.002, 0.011),
    face=Surface(0.6, mottle=0.015, grain=0.02),
    background=Surface(0.15, mottle=0.03, mottle_size=4 * MM),
    edges=Edges(0.015 * MM),
    sensor=Sensor(blur=1.0),
)


def strips(start, stop, factor, edges=("hinge", "bottom")):
    return tuple(Strip(edge, start * MM, stop * MM, factor) for edge in edges)


def frame(wide, factor):
    """A strip round the face that is as dark or bright at its corner as along the edges."""
    return (
        *strips(-1.0, wide, factor),
        Strip("hinge", -1.0 * MM, wide * MM, 1.0 / factor, last=wide * MM),
    )


SEEN = {
    "dark band of 0.5 mm": {"strips": strips(-1.0, 0.5, 0.6)},
    "dark band of 0.8 mm": {"strips": strips(-1.0, 0.8, 0.6)},
    "dark band of 0.8 mm, a little darker": {"strips": strips(-1.0, 0.8, 0.75)},
    "bevel of 1.5 mm": {"back_edge": BackEdge(1.5 * MM, 1.5 * MM, 1.5 * MM, 0.5)},
    "lip behind the hinge edge": {"back_edge": BackEdge(1.6 * MM, 0.0, 3.0 * MM, 0.5)},
    "dark band of 1.6 mm along the hinge edge": {"strips": strips(-1.0, 1.6, 0.6, ("hinge",))},
    "dark band of 2.5 mm along the bottom edge": {"strips": strips(-1.0, 2.5, 0.7, ("bottom",))},
    "grooves beside both edges": {"strips": strips(7.0, 8.5, 0.5)},
}


@pytest.mark.parametrize("wide", [6.0, 8.0])
@pytest.mark.parametrize("factor", [0.45, 0.85, 1.2])
def test_what_frames_the_face_as_wide_along_both_edges_is_a_lipping(wide, factor, camera, layout):
    # Of solid wood: where its strips cross it is as bright as they are.
    lipped = replace(SCENE, strips=frame(wide, factor))
    found = localize(render_picture(lipped, 6), camera, layout, WIDTH, THICKNESS).offset
    assert np.hypot(found.y - SCENE.offset.y, found.z - SCENE.offset.z) < 0.03 * MM


@pytest.mark.parametrize(
    ("hinge", "bottom", "setback"), [(4.0, 4.0, 4.0), (14.0, 14.0, 25.0), (3.0, 3.0, 2.0)]
)
@pytest.mark.parametrize("factor", [0.45, 0.6])
def test_what_shrinks_towards_the_optical_axis_lies_behind_the_face(
    hinge, bottom, setback, factor, camera, layout
):
    behind = replace(SCENE, back_edge=BackEdge(hinge * MM, bottom * MM, setback * MM, factor))
    found = localize(render_picture(behind, 6), camera, layout, WIDTH, THICKNESS).offset
    assert np.hypot(found.y - SCENE.offset.y, found.z - SCENE.offset.z) < 0.03 * MM


@pytest.mark.parametrize(
    "around", [{"back_edge": BackEdge(1.0 * MM, 1.0 * MM, 1.0 * MM, 0.6)}, {"strips": frame(1.0, 0.6)}]
)
def test_what_frames_the_face_and_is_too_narrow_to_tell_is_refused(around, camera, layout):
    with pytest.raises(WrongEdge, match=r"two steps .* may be the \w+ edge"):
        localize(render_picture(replace(SCENE, **around), 6), camera, layout, WIDTH, THICKNESS)


BEVELS = {"hinge": (2.0 * MM, 0.0), "bottom": (0.0, 2.0 * MM)}


@pytest.mark.parametrize("name", SEEN)
def test_the_edge_of_the_face_is_found(name, camera, layout):
    scene = replace(SCENE, **SEEN[name])
    found = localize(render_picture(scene, 6), camera, layout, WIDTH, THICKNESS).offset
    assert np.hypot(found.y - scene.offset.y, found.z - scene.offset.z) < 0.03 * MM


@pytest.mark.parametrize("brightness", [0.6, 1.15, 1.3])
@pytest.mark.parametrize("edge", BEVELS)
def test_a_bevel_along_one_edge_is_not_taken_for_a_band(edge, brightness, camera, layout):
    bevel = BackEdge(*BEVELS[edge], 1.0 * MM, brightness)
    with pytest.raises(WrongEdge, match=rf"two steps .* may be the {edge} edge"):
        localize(render_picture(replace(SCENE, back_edge=bevel), 6), camera, layout, WIDTH, THICKNESS)


@pytest.mark.parametrize("factor", [0.9, 1.15, 1.3])
@pytest.mark.parametrize("edge", BEVELS)
def test_a_bright_lipping_along_one_edge_is_not_taken_for_a_bevel(edge, factor, camera, layout):
    scene = replace(SCENE, strips=strips(-1.0, 2.0, factor, (edge,)))
    found = localize(render_picture(scene, 6), camera, layout, WIDTH, THICKNESS).offset
    assert np.hypot(found.y - scene.offset.y, found.z - scene.offset.z) < 0.03 * MM


def test_bands_of_which_one_alone_can_be_read_by_itself_are_on_the_face_along_both_edges(camera, layout):
    off = []
    for widths, seed in product([(0.48, 0.62), (0.62, 0.48), (0.52, 0.56), (0.56, 0.52)], range(4)):
        bands = [strips(-1.0, wide, 0.53, (edge,)) for edge, wide in zip(EDGES, widths, strict=True)]
        scene = replace(SCENE, face=Surface(0.5, mottle=0.015, grain=0.02), strips=tuple(chain(*bands)))
        with suppress(WrongEdge):
            found = localize(render_picture(scene, seed), camera, layout, WIDTH, THICKNESS).offset
            off.append(np.hypot(found.y - scene.offset.y, found.z - scene.offset.z))
    assert len(off) >= 12
    assert max(off) < 0.1 * MM  # a rim taken for what it is not is half a millimetre


@pytest.mark.parametrize(
    ("factor", "blur", "seed"), [(1.15, 0.8, 0), (1.15, 1.0, 0), (1.19, 1.0, 1), (1.25, 1.0, 1)]
)
def test_a_bright_arris_hardly_wider_than_a_pixel_is_not_taken_for_a_dark_one(
    factor, blur, seed, camera, layout
):
    scene = replace(
        SCENE,
        face=Surface(0.62, mottle=0.015, grain=0.01),
        sensor=Sensor(blur=blur),
        strips=strips(-1.0, 0.12, factor),
    )
    found = localize(render_picture(scene, seed), camera, layout, WIDTH, THICKNESS).offset
    assert np.hypot(found.y - scene.offset.y, found.z - scene.offset.z) < 0.03 * MM
