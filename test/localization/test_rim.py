"""A rim along an edge is found in the mean profile, and a soft lens is not taken for one."""

from math import erf, sqrt

import numpy as np
import pytest

from doormill_ros.localization.edge_points.blur import Spread, bin_places
from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.rims.rim import Rim, check_alike, check_placed, check_readable, find_rim

PLACE = bin_places(47)
PIXEL = 1e-4


def soft(at, blur):
    """A step at `at` seen with a Gaussian point spread and the pixel's own width."""
    sigma = sqrt(blur**2 + 1 / 12)
    return np.array([0.5 * (1 + erf((x - at) / sigma / sqrt(2))) for x in PLACE])


def spread(profile, seed=3):
    rng = np.random.default_rng(seed)
    noise = 1e-3
    single = min(
        (float(np.sqrt(np.mean((profile - soft(0.0, b)) ** 2))), b) for b in np.geomspace(0.5, 4, 30)
    )
    noisy = profile + noise * rng.standard_normal(PLACE.size)
    return Spread(single[1], single[0], noise, noisy, np.full(PLACE.size, noise), PLACE)


@pytest.mark.parametrize(("width", "brightness"), [(3.0, -0.75), (3.0, 0.5), (6.0, 0.3)])
def test_outer_border_of_a_rim(width, brightness):
    outer = 0.4
    profile = (1 + brightness) * soft(outer, 1.0) - brightness * soft(outer - width, 1.0)
    rim = find_rim(spread(profile), 0.0)
    assert rim is not None
    assert rim.shift == pytest.approx(outer, abs=max(5 * rim.deviation, 0.02))
    assert rim.width == pytest.approx(width, abs=0.4)
    assert rim.brightness == pytest.approx(brightness, abs=0.1)


@pytest.mark.parametrize(("beyond", "gap"), [(1.3, True), (1.05, True), (0.7, False)])
@pytest.mark.parametrize("width", [6.0, 8.0, 10.0])
def test_beyond_a_gap_may_stand_what_is_brighter_than_the_face(width, beyond, gap):
    rim = find_rim(spread(soft(0.0, 1.0) - beyond * soft(width, 1.0)), 0.0)  # 0 is the face, 1 the gap
    assert rim is not None
    assert rim.gap is gap
    assert rim.shift - rim.width == pytest.approx(0.0, abs=0.05)


def test_one_step_has_no_rim():
    assert find_rim(spread(soft(0.2, 1.3)), 0.0) is None


def test_a_defocused_lens_is_no_rim():
    radius = 3.0
    nodes = np.linspace(-1, 1, 401)[1:-1]
    weight = np.sqrt(1 - nodes**2)
    profile = sum(w * soft(radius * n, 0.7) for n, w in zip(nodes, weight / weight.sum(), strict=True))
    assert find_rim(spread(profile), 0.0) is None


def test_a_rim_whose_place_is_open_is_refused():
    rim = Rim(shift=1.0, deviation=0.8, width=2.0, brightness=-0.8, blur=1.0, misfit=0.002)
    with pytest.raises(WrongEdge, match=r"known to 0\.08 mm only, allowed are 0\.03 mm"):
        check_placed("hinge", rim, PIXEL)


def test_a_dark_rim_too_wide_for_an_arris_is_refused_where_it_is_too_soft_to_read_its_end():
    soft, sharp = (Rim(1.0, 0.05, width=7.0, brightness=-0.5, blur=b, misfit=0.002) for b in (2.0, 1.0))
    with pytest.raises(WrongEdge, match=r"two steps 0\.70 mm apart"):
        check_readable("bottom", soft, PIXEL)
    check_readable("bottom", sharp, PIXEL)
    check_readable("bottom", Rim(1.0, 0.05, width=7.0, brightness=0.5, blur=2.0, misfit=0.002), PIXEL)


def test_an_edge_softer_than_one_with_a_rim_hides_a_rim():
    rim = Rim(shift=1.0, deviation=0.05, width=2.0, brightness=-0.8, blur=1.0, misfit=0.002)
    with pytest.raises(WrongEdge, match=r"the hinge edge is 1\.40 px soft"):
        check_alike({"hinge": None, "bottom": rim}, {"hinge": 1.4, "bottom": 1.0})
    check_alike({"hinge": None, "bottom": rim}, {"hinge": 1.05, "bottom": 1.0})


def test_a_narrow_rim_nearly_as_dark_as_the_background_is_found():
    profile = 0.2 * soft(1.5, 0.85) + 0.8 * soft(-0.3, 0.85)
    rim = find_rim(spread(profile), 0.0)
    assert rim is not None
    assert rim.shift == pytest.approx(1.5, abs=max(3 * rim.deviation, 0.1))


def test_a_rim_half_as_dark_as_the_background_is_found_and_a_fibrous_edge_is_none():
    rim = find_rim(spread(0.4 * soft(1.5, 0.95) + 0.6 * soft(-0.9, 0.95)), 0.0)
    assert rim is not None
    assert rim.shift == pytest.approx(1.5, abs=0.2)
    fibrous = np.mean([soft(at, 0.9) for at in np.linspace(-2.0, 2.0, 101)], axis=0)
    assert find_rim(spread(fibrous), 0.0) is None


def test_the_blur_of_the_other_edge_shows_a_rim_that_looks_like_softness():
    seen = spread(0.5 * soft(0.7, 1.0) + 0.5 * soft(-0.7, 1.0))
    assert find_rim(seen, 0.0) is None
    rim = find_rim(seen, 0.0, sharp=1.0)
    assert rim is not None
    assert rim.shift == pytest.approx(0.7, abs=max(3 * rim.deviation, 0.1))
