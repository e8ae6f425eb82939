"""Of two doors one behind the other the first one's corner is looked for, and mitred bevels are no lippings."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Blot, Edges, PictureScene, Strip, Surface
from doormill_ros.units import DEG, MM

WIDTH, THICKNESS = 0.9, 0.05
OFFSET = DoorOffset(0.003, -0.002, 0.008)
PLAIN = PictureScene(
    WIDTH,
    THICKNESS,
    OFFSET,
    face=Surface(0.6, mottle=0.015, grain=0.02),
    background=Surface(0.18, mottle=0.03, mottle_size=4 * MM),
    edges=Edges(0.015 * MM),
)


def second_door(hinge, bottom, turn, factor):
    """A door behind that shows outside of the first one's edges by so much at the corner [mm], turned [rad]."""
    c, s = np.cos(turn), np.sin(turn)
    corners = MM * np.array([[0.0, 0.0], [400.0, 0.0], [400.0, 400.0], [0.0, 400.0]])
    turned = corners @ np.array([[c, s], [-s, c]]) - MM * np.array([hinge, bottom])
    return Blot(turned, factor * PLAIN.face.brightness, behind=True)


def locate(camera, layout, *blots, **change):
    picture = render_picture(replace(PLAIN, blots=blots, **change), 4)
    return localize(picture, camera, layout, WIDTH, THICKNESS)


@pytest.mark.parametrize("turn", [-0.9 * DEG, 0.3 * DEG, 0.9 * DEG])
@pytest.mark.parametrize(("hinge", "bottom", "factor"), [(2.5, 2.5, 0.92), (2.5, 2.5, 1.1), (3.0, 4.0, 1.1)])
def test_a_second_door_turned_against_the_first_is_told_by_the_corner_within(
    hinge, bottom, factor, turn, camera, layout
):
    with pytest.raises(WrongEdge, match="within the corner that was found another one shows") as refusal:
        locate(camera, layout, second_door(hinge, bottom, turn, factor))
    view = face_view(camera, layout, WIDTH, THICKNESS)
    for edge, pixels in refusal.value.data["marks"]:
        y, z = view.points(pixels).T - np.array([OFFSET.y, OFFSET.z])[:, None]
        off = y + OFFSET.rotation * z if edge == "hinge" else z - OFFSET.rotation * y
        assert np.abs(off).max() < 0.5 * MM


@pytest.mark.parametrize(("hinge", "bottom", "factor"), [(5.0, 1.7, 0.93), (1.8, 4.0, 0.9), (1.8, 4.0, 0.93)])
def test_a_second_door_that_shows_by_other_widths_is_not_taken_for_a_lipping(
    hinge, bottom, factor, camera, layout
):
    with pytest.raises(WrongEdge, match=r"two steps .* may be the hinge edge"):
        locate(camera, layout, second_door(hinge, bottom, 0.0, factor))


def facet(edge, wide, factor):
    """A bevel along an edge, mitred with the other one's, that leaves the flat face so much smaller [mm]."""
    corners = MM * np.array([[0.0, 0.0], [wide, wide], [wide, 400.0], [0.0, 400.0]])
    return Blot(corners if edge == "hinge" else corners[:, ::-1], factor * PLAIN.face.brightness)


@pytest.mark.parametrize("wide", [2.5, 3.0, 4.5])
@pytest.mark.parametrize(("hinge", "bottom"), [(1.12, 0.72), (0.72, 1.12), (0.72, 0.93), (1.0, 0.5)])
def test_bevels_that_meet_in_a_mitre_are_not_taken_for_lippings(wide, hinge, bottom, camera, layout):
    with pytest.raises(WrongEdge, match=r"two steps .* may be the"):
        locate(camera, layout, facet("hinge", wide, hinge), facet("bottom", wide, bottom))


@pytest.mark.parametrize("wide", [3.0, 4.5])
@pytest.mark.parametrize("factor", [0.72, 1.12])
@pytest.mark.parametrize("edge", ["hinge", "bottom"])
def test_a_lipping_cut_off_straight_is_not_taken_for_a_bevel(edge, wide, factor, camera, layout):
    lipping = Strip(edge, -1.0 * MM, wide * MM, factor)
    found = localize(
        render_picture(replace(PLAIN, strips=(lipping,)), 4), camera, layout, WIDTH, THICKNESS
    ).offset
    assert np.hypot(found.y - OFFSET.y, found.z - OFFSET.z) < 0.03 * MM
