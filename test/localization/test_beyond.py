"""The edge of a lipped door that stands out of range is not the inner border of its lipping, which does not."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import OutOfRange
from doormill_ros.localization.localizer import localize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import Blot, Edges, PictureScene, Strip, Surface
from doormill_ros.units import MM

WIDTH, THICKNESS = 0.9, 0.04
PLAIN = PictureScene(
    WIDTH,
    THICKNESS,
    DoorOffset(0.0, 0.0, 0.006),
    face=Surface(0.6, mottle=0.015),
    background=Surface(0.18, mottle=0.03, mottle_size=4 * MM),
    edges=Edges(0.015 * MM),
)
#: Where a door stands whose lipping along an edge reaches into the range [m].
STANDS = {"hinge": (-15.0 * MM, 2.0 * MM), "bottom": (2.0 * MM, -15.0 * MM)}


def look(camera, layout, scene):
    return localize(render_picture(scene, 4), camera, layout, WIDTH, THICKNESS)


@pytest.mark.parametrize("factor", [0.8, 0.9, 1.15])
@pytest.mark.parametrize("wide", [14.0, 20.0])
@pytest.mark.parametrize("edge", ["hinge", "bottom"])
def test_a_lipped_door_out_of_range_is_told_where_it_stands(edge, wide, factor, camera, layout):
    lipping = Strip(edge, start=-1.0 * MM, stop=wide * MM, factor=factor)
    offset = DoorOffset(*STANDS[edge], 0.006)
    with pytest.raises(OutOfRange) as refusal:
        look(camera, layout, replace(PLAIN, offset=offset, strips=(lipping,)))
    found = refusal.value.data["offset"]
    assert np.hypot(found.y - offset.y, found.z - offset.z) < 0.3 * MM


@pytest.mark.parametrize("edge", ["hinge", "bottom"])
@pytest.mark.parametrize("grey", [0.02, 0.9])
def test_a_rail_behind_with_a_larger_step_out_of_range_does_no_harm(edge, grey, camera, layout):
    corners = MM * np.array([[-60.0, -80.0], [-19.0, -80.0], [-19.0, 300.0], [-60.0, 300.0]])
    rail = Blot(corners if edge == "hinge" else corners[:, ::-1], grey, behind=True)
    face = Surface(0.3, mottle=0.015)
    scene = replace(PLAIN, face=face, background=Surface(0.45 if grey < 0.1 else 0.2), blots=(rail,))
    found = look(camera, layout, scene)
    assert np.hypot(found.offset.y, found.offset.z) < 0.05 * MM
