"""A rounded arris, a slope that ends at the outline of the face, is told from softness, or the door is refused."""

from math import erf, hypot, sqrt

import numpy as np
import pytest

from doormill_ros.localization.edge_points.blur import Spread, bin_places
from doormill_ros.localization.edge_points.texture import Variograms
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.rims.arris import Profile
from doormill_ros.localization.rims.rounded import both_rounded, find_rounded
from doormill_ros.localization.rims.sharpness import Softness, hidden
from doormill_ros.localization.view import face_view
from doormill_ros.units import MM
from support.views.render import render
from support.views.series import view_of

PLACE, PIXEL, STEP, NOISE = bin_places(47), 1e-4, 100.0, 1e-3
CALM = Variograms(np.full(25, 0.1), np.zeros(25))


def soft(at, blur):
    """A step at `at` seen with a Gaussian point spread and the pixel's own width."""
    sigma = sqrt(blur**2 + 1 / 12)
    return np.array([0.5 * (1 + erf((x - at) / sigma / sqrt(2))) for x in PLACE])


def rounded(width, left, blur, at):
    """A face that darkens over `width` px up to its outline `at`, where `left` of the step is left."""
    slope = np.mean([soft(at - part * width, blur) for part in (np.arange(200) + 0.5) / 200], axis=0)
    return left * soft(at, blur) + (1 - left) * slope


def profile(shape, seems, seed=2):
    """The shape as 800 rows of an edge show it that seems as soft as one step of that blur."""
    seen = shape + NOISE * np.random.default_rng(seed).standard_normal(PLACE.size)
    return Profile(Spread(seems, 0.005, NOISE, seen, np.full(PLACE.size, NOISE), PLACE), STEP, CALM, CALM)


@pytest.mark.parametrize(
    ("width", "left", "blur", "seems"), [(2.6, 0.35, 0.9, 1.15), (3.4, 0.2, 1.1, 1.55), (2.4, 0.6, 0.8, 1.0)]
)
def test_a_rounded_arris_is_told_from_softness_and_its_outline_placed(width, left, blur, seems):
    at = 0.5 * width * (1 - left)
    found = find_rounded(profile(rounded(width, left, blur, at), seems), None, PIXEL)
    assert found is not None
    outline, wide, sharp = found.mean()
    deviation = np.sqrt(np.diag(found.covariance()))
    assert outline == pytest.approx(at, abs=3 * deviation[0])
    assert wide == pytest.approx(width, abs=max(3 * deviation[1], 0.3))
    assert sharp == pytest.approx(blur, abs=max(3 * deviation[2], 0.05))
    assert deviation[0] < 0.3


def test_the_outline_is_as_uncertain_as_it_scatters():
    off = []
    for seed in range(40):
        seen = profile(rounded(2.6, 0.35, 0.9, 0.85), 1.15, seed)
        found = find_rounded(seen, None, PIXEL)
        if found is not None:
            off.append((found.mean()[0] - 0.85) / np.sqrt(found.covariance()[0, 0]))
    assert len(off) > 35
    assert np.mean(np.abs(off) < 2) > 0.85


def test_what_is_alike_from_both_ends_is_no_rounded_arris():
    nodes = np.linspace(-1, 1, 201)[1:-1]
    disc = np.sqrt(1 - nodes**2) / np.sqrt(1 - nodes**2).sum()
    lens = profile(soft(0.1, 1.1), 1.1)
    defocused = profile(sum(w * soft(2.0 * n, 0.8) for n, w in zip(nodes, disc, strict=True)), 1.35)
    fibrous = profile(np.mean([soft(1.5 * n, 0.9) for n in nodes], axis=0), 1.25)
    sharpened = profile(1.3 * soft(0.0, 0.9) - 0.15 * (soft(1.6, 1.0) + soft(-1.6, 1.0)), 0.7)
    for one in (lens, defocused, fibrous, sharpened):
        assert find_rounded(one, None, PIXEL) is None


def test_chance_is_no_rounded_arris():
    found = [find_rounded(profile(soft(0.0, 1.0), 1.0, seed), None, PIXEL) for seed in range(60)]
    assert not any(both_rounded({"hinge": one}, {}, PIXEL) for one in found if one is not None)


def test_one_edge_tells_the_other_where_its_arris_ends():
    # As dark as the background at its outline, an arris spreads the step evenly: by itself it is softness.
    hinge = profile(rounded(3.0, 0.4, 0.9, 0.9), 1.2)
    bottom = profile(rounded(3.0, 0.0, 0.9, 1.5), 1.28)
    found = find_rounded(hinge, None, PIXEL)
    assert find_rounded(bottom, None, PIXEL) is None
    rims = both_rounded({"hinge": found}, {"hinge": hinge, "bottom": bottom}, PIXEL)
    assert rims["bottom"].shift == pytest.approx(1.5, abs=3 * rims["bottom"].deviation)
    assert rims["bottom"].width == pytest.approx(3.0, abs=0.4)
    assert rims["hinge"].shift == pytest.approx(0.9, abs=3 * rims["hinge"].deviation)


@pytest.mark.parametrize("number", [11, 46, 53, 61, 101])
def test_a_door_with_rounded_arrises_is_found_by_its_outline(number, camera, layout):
    view = view_of(number, 900, ("round_arris",))
    found = localize(render(view), camera, layout, view.place.width, view.told_thickness).offset
    assert np.hypot(found.y - view.offset.y, found.z - view.offset.z) < 0.05 * MM


@pytest.mark.parametrize(
    ("number", "seed", "features"), [(218, 51, None), (60, 51, None), (78, 900, ("round_arris",))]
)
def test_a_rounded_arris_whose_end_is_not_seen_is_refused(number, seed, features, camera, layout):
    view = view_of(number, seed, features)
    with pytest.raises(WrongEdge, match="a rounded arris lies along it, whose outer border is known to"):
        localize(render(view), camera, layout, view.place.width, view.told_thickness)


@pytest.mark.parametrize("number", [64, 87, 103, 109])
def test_an_edge_softer_than_the_other_may_hide_its_outline_and_is_refused(number, camera, layout):
    view = view_of(number, 771001, ("round_arris",))
    with pytest.raises(WrongEdge, match="the outer border of a rounded arris may hide in it"):
        localize(render(view), camera, layout, view.place.width, view.told_thickness)


def test_a_slope_hides_half_its_width_in_the_softness_it_makes(camera, layout):
    view, lens, width = face_view(camera, layout, 0.86, 0.04), 1.0, 3.0
    found = hidden({"hinge": Softness(lens), "bottom": Softness(hypot(lens, width / sqrt(12)))}, view)
    assert found["hinge"] == 0.0
    # The lens itself may be a little softer along one edge.
    assert 0.4 * width < found["bottom"] < 0.5 * width
    for uncertain in (Softness(1.3, deviation=0.2), Softness(1.3, ragged=0.9), Softness(1.02)):
        assert hidden({"hinge": Softness(lens), "bottom": uncertain}, view)["bottom"] == 0.0


@pytest.mark.parametrize("number", [157, 202])
def test_streaks_that_make_an_edge_seem_soft_hide_nothing(number, camera, layout):
    view = view_of(number, 51)
    found = localize(render(view), camera, layout, view.place.width, view.told_thickness).offset
    assert np.hypot(found.y - view.offset.y, found.z - view.offset.z) < 0.05 * MM
