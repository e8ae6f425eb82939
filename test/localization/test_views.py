"""Views of another world of pictures, drawn ray by ray from solid things; it shares nothing with the localizer."""

import numpy as np
import pytest

from doormill_ros.localization.errors import LocalizationError, WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.units import DEG, MM
from support.views.plainness import is_plain
from support.views.render import render
from support.views.series import view_of


def off(view, camera, layout):
    """How far from its place the door is found [m], and how much turned [rad]."""
    found = localize(render(view), camera, layout, view.place.width, view.told_thickness).offset
    return np.hypot(found.y - view.offset.y, found.z - view.offset.z), abs(
        found.rotation - view.offset.rotation
    )


@pytest.mark.parametrize(
    ("number", "seed", "features"),
    [
        (34, 3, ("lipping",)),
        (38, 3, ("lipping",)),
        (46, 3, ("lipping",)),
        (49, 3, ("lipping",)),
        (82, 11, None),
        (112, 11, None),
        (105, 2, None),  # a metal plate on the face
        (13, 12, None),
        (54, 1, None),  # a drip groove
        (10, 31, None),  # a slot, and dust where the face beside it ends
        (59, 31, None),  # a bright bench below an edge in the shadow
        (11, 4, ("rebate",)),  # of the tone of the face: a notch at the corner is all that shows
        (20, 4, ("rebate",)),
        (17, 4, ("rubber_seal",)),
        (29, 1, None),
    ],
)
def test_what_runs_along_an_edge_is_not_taken_for_it(number, seed, features, camera, layout):
    view = view_of(number, seed, features)
    try:
        place, turn = off(view, camera, layout)
    except WrongEdge:
        return
    assert (place < 0.1 * MM, turn < 0.1 * DEG) == (True, True)


@pytest.mark.parametrize(
    ("number", "seed"),
    [
        # A groove, a pencil's or a burnt line and a band end with the face, and stripes of a curtain or a rail beyond.
        *((number, 18018) for number in (74, 100, 101)),
    ],
)
def test_a_plain_edge_is_found_whatever_lies_beyond_its_end(number, seed, camera, layout):
    place, turn = off(view_of(number, seed), camera, layout)
    assert (place < 0.1 * MM, turn < 0.1 * DEG) == (True, True)


def test_a_plain_view_is_seldom_refused_and_never_wrong(camera, layout):
    views = [view for view in (view_of(number, 31) for number in range(60)) if is_plain(view)]
    found = []
    for view in views:
        try:
            found.append(off(view, camera, layout))
        except LocalizationError:
            continue
    assert len(views) > 30
    assert len(found) > 0.6 * len(views)
    place, turn = np.array(found).T
    assert place.max() < 0.1 * MM
    assert turn.max() < 0.1 * DEG
