"""What lies before an edge is no edge: its line runs on past the corner, or the edge shows beside its end."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.overlay import draw_refusal
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Blot, Chip, Edges, PictureScene, Surface
from doormill_ros.units import MM

WIDTH, THICKNESS = 0.9, 0.05
OFFSET = DoorOffset(0.003, -0.002, 0.008)
PLAIN = PictureScene(
    WIDTH,
    THICKNESS,
    OFFSET,
    face=Surface(0.6, mottle=0.015),
    background=Surface(0.18, mottle=0.03, mottle_size=4 * MM),
    edges=Edges(0.015 * MM),
)


def box(edge, low, high, start, stop, grey, behind=False):
    """A rectangle from `low` to `high` inwards of an edge and from `start` to `stop` along it [mm]."""
    corners = MM * np.array([[low, start], [high, start], [high, stop], [low, stop]])
    return Blot(corners if edge == "hinge" else corners[:, ::-1], grey, behind=behind)


def look(camera, layout, *blots, **change):
    """What is found in the picture of the plain door with that before it."""
    picture = render_picture(replace(PLAIN, blots=blots, **change), 4)
    return picture, lambda: localize(picture, camera, layout, WIDTH, THICKNESS)


def off(found):
    """Distance of a pose from the truth [m]."""
    return np.hypot(found.offset.y - OFFSET.y, found.offset.z - OFFSET.z)


def is_drawn(picture, refusal):
    """Whether all marks of a refusal are on its overlay."""
    changed = np.any(draw_refusal(picture, refusal) != cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB), axis=2)
    middles = [np.rint(pixels.mean(axis=0)).astype(int) for _, pixels in refusal.data["marks"]]
    return all(changed[v - 2 : v + 3, u - 2 : u + 3].any() for u, v in middles)


@pytest.mark.parametrize("edge", ["hinge", "bottom"])
@pytest.mark.parametrize("grey", [0.05, 0.1, 0.3, 0.35, 0.75])
@pytest.mark.parametrize("past", [20.0, 60.0])
def test_what_covers_an_edge_and_runs_on_past_the_corner_is_told(edge, grey, past, camera, layout):
    picture, found = look(camera, layout, box(edge, -60.0, 4.0, -past, 300.0, grey))
    with pytest.raises(WrongEdge, match=f"taken for the {edge} edge runs on past the corner") as refusal:
        found()
    assert is_drawn(picture, refusal.value)
    ((_, pixels),) = refusal.value.data["marks"]
    view = face_view(camera, layout, WIDTH, THICKNESS)
    corner = view.pixels(np.array([[OFFSET.y, OFFSET.z]]))[0]
    along = pixels[:, 1 if edge == "hinge" else 0]
    assert along.min() < corner[1 if edge == "hinge" else 0] < along.max()


@pytest.mark.parametrize("edge", ["hinge", "bottom"])
@pytest.mark.parametrize("start", [5.0, 10.0, 20.0])
def test_tape_over_an_edge_is_told_by_what_shows_beside_its_end(edge, start, camera, layout):
    picture, found = look(camera, layout, box(edge, -3.0, 6.0, start, 300.0, 0.75))
    with pytest.raises(
        WrongEdge, match=rf"the {edge} edge begins \d+ mm from the corner, .* 3\.\d mm"
    ) as refusal:
        found()
    assert [name for name, _ in refusal.value.data["marks"]] == ["line", "other"]
    assert is_drawn(picture, refusal.value)


@pytest.mark.parametrize("edge", ["hinge", "bottom"])
@pytest.mark.parametrize("below", [0.15, 0.3, 0.6, 0.9, 2.0])
@pytest.mark.parametrize("start", [5.0, 10.0])
def test_a_second_door_that_shows_below_the_first_and_ends_before_its_corner_is_told(
    edge, below, start, camera, layout
):
    # As bright as the first: nothing but its end tells that the line taken for the edge is its own.
    second = box(edge, -below, 5.0, start, 300.0, PLAIN.face.brightness, behind=True)
    picture, found = look(camera, layout, second)
    with pytest.raises(WrongEdge, match=rf"the {edge} edge begins \d+ mm from the corner") as refusal:
        found()
    assert [name for name, _ in refusal.value.data["marks"]] == ["line", "other"]
    assert is_drawn(picture, refusal.value)


@pytest.mark.parametrize("wide", [3.0, 12.0])
@pytest.mark.parametrize("start", [30.0, 36.0])
@pytest.mark.parametrize("edge", ["hinge", "bottom"])
def test_what_hangs_over_most_of_an_edge_is_told_by_the_rest(edge, start, wide, camera, layout):
    _, found = look(camera, layout, box(edge, -wide, 6.0, start, 300.0, 0.75))
    with pytest.raises(WrongEdge, match=rf"the {edge} edge begins \d+ mm from the corner"):
        found()


@pytest.mark.parametrize("away", [1.5, 4.0])
@pytest.mark.parametrize("edge", ["hinge", "bottom"])
def test_a_rail_behind_that_runs_on_beside_the_edge_does_no_harm(edge, away, camera, layout):
    _, found = look(camera, layout, box(edge, -away - 10.0, -away, -60.0, 300.0, 0.5, behind=True))
    assert off(found()) < 0.05 * MM


@pytest.mark.parametrize("size", [4.0, 6.0, 9.0, 12.0, 25.0])
def test_a_broken_corner_is_no_second_edge(size, camera, layout):
    chips = tuple(Chip(edge, 0.0, 2 * size * MM, 0.6 * size * MM) for edge in ("hinge", "bottom"))
    _, found = look(camera, layout, edges=replace(PLAIN.edges, chips=chips))
    assert off(found()) < 0.05 * MM


@pytest.mark.parametrize("edge", ["hinge", "bottom"])
@pytest.mark.parametrize("long", [2.0, 5.0, 8.0, 12.0])
@pytest.mark.parametrize("deep", [0.06, 0.3])
def test_a_shallow_chip_in_the_corner_is_no_second_edge(edge, long, deep, camera, layout):
    # From 0.1 mm on a chip with a flat floor may look like another edge; one so shallow does no harm.
    edges = replace(PLAIN.edges, chips=(Chip(edge, 0.0, 2 * long * MM, deep * MM),))
    _, found = look(camera, layout, edges=edges)
    assert off(found()) < 0.05 * MM


@pytest.mark.parametrize(
    ("edge", "long", "deep"), [("hinge", 5.0, 0.12), ("bottom", 6.0, 0.16), ("bottom", 9.0, 0.18)]
)
def test_a_chip_that_leads_back_to_the_edge_is_no_second_one(edge, long, deep, camera, layout):
    edges = replace(PLAIN.edges, chips=(Chip(edge, 0.0, 2 * long * MM, deep * MM),))
    _, found = look(camera, layout, edges=edges)
    assert off(found()) < 0.05 * MM


def test_joints_of_a_wall_behind_do_no_harm(camera, layout):
    joints = [
        box("bottom", at, at + 2.0, -60.0, 300.0, 0.1, behind=True) for at in np.arange(-31.3, 0.0, 6.0)
    ]
    _, found = look(camera, layout, *joints)
    assert off(found()) < 0.05 * MM


@pytest.mark.parametrize("wide", [0.7, 0.8, 0.9])
def test_a_bright_strip_beside_an_edge_that_hides_it_from_wide_windows_is_refused(wide, camera, layout):
    corners = MM * np.array([[-wide, -wide], [10.0, 10.0], [10.0, 300.0], [-wide, 300.0]])
    lit, shaded = Blot(corners, 0.72, behind=True), Blot(corners[:, ::-1], 0.3, behind=True)
    picture, found = look(camera, layout, lit, shaded)
    nearest = "another step lies so near to the hinge edge" if wide < 0.85 else "two steps 1.1 mm apart"
    with pytest.raises(WrongEdge, match=nearest) as refusal:
        found()
    assert is_drawn(picture, refusal.value)
