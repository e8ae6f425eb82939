"""What a camera does to its pictures: sharpening is refused, what leaves an edge alike from both ends is no rim."""

from math import erf, sqrt

import cv2
import numpy as np
import pytest

from doormill_ros.localization.edge_points.blur import Spread, bin_places
from doormill_ros.localization.errors import LocalizationError, ProcessedPicture
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.rims.processing import check_levels, check_overshoot, level_counts
from doormill_ros.localization.rims.rim import find_rim
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.units import MM
from support.pictures.conditions import pictures

PLACE = bin_places(47)
NOISE = 1e-3


def soft(at, blur):
    """A step at `at` seen with a Gaussian point spread and the pixel's own width."""
    sigma = sqrt(blur**2 + 1 / 12)
    return np.array([0.5 * (1 + erf((x - at) / sigma / sqrt(2))) for x in PLACE])


def sharpened(at, blur, sigma, amount):
    return (1 + amount) * soft(at, blur) - amount * soft(at, sqrt(blur**2 + sigma**2))


def spread(profile, blur=1.0):
    noisy = profile + NOISE * np.random.default_rng(3).standard_normal(PLACE.size)
    misfit = float(np.sqrt(np.mean((profile - soft(0.0, blur)) ** 2)))
    return Spread(blur, misfit, NOISE, noisy, np.full(PLACE.size, NOISE), PLACE)


@pytest.mark.parametrize(("sigma", "amount"), [(1.0, 1.0), (1.5, 0.5), (2.0, 0.5), (4.0, 0.3)])
def test_a_sharpened_edge_is_refused_for_that(sigma, amount):
    with pytest.raises(ProcessedPicture, match="the camera has sharpened it; switch sharpening"):
        check_overshoot("hinge", spread(sharpened(0.1, 0.9, sigma, amount)), 0.0)


def test_beside_a_rim_darker_than_the_background_less_of_it_is_told():
    seen = spread(sharpened(0.1, 1.0, 1.0, 0.5))
    check_overshoot("hinge", seen, 0.0)
    with pytest.raises(ProcessedPicture):
        check_overshoot("hinge", seen, 0.0, rim=True)


@pytest.mark.parametrize("rim", [False, True])
@pytest.mark.parametrize(
    "profile",
    [
        soft(0.2, 1.3),
        soft(0.2, 8.0),
        1.3 * soft(0.4, 1.0) - 0.3 * soft(-2.6, 1.0),
        0.25 * soft(0.4, 1.0) + 0.75 * soft(-2.6, 1.0),
        -0.1 * soft(2.0, 1.0) + 1.1 * soft(0.0, 1.0),
    ],
    ids=["sharp", "defocused", "bright rim", "burnt arris", "rim darker than the background"],
)
def test_what_no_camera_has_sharpened_is_not_taken_for_it(profile, rim):
    check_overshoot("hinge", spread(profile), 0.0, rim)


def test_an_edge_that_is_alike_from_both_ends_has_no_rim():
    assert find_rim(spread(sharpened(0.1, 0.8, 1.0, 1.0)), 0.0) is None


def unsharp(sigma, amount):
    def change(picture):
        grey = picture.astype(np.float32)
        sharp = grey + amount * (grey - cv2.GaussianBlur(grey, (0, 0), sigma))
        return np.clip(np.rint(sharp), 0, 255).astype(np.uint8)

    return change


CHANGES = {
    "sharpened a little": unsharp(1.0, 0.5),
    "sharpened": unsharp(1.0, 1.0),
    "sharpened widely": unsharp(1.5, 0.5),
    "sharpened more widely": unsharp(2.0, 0.5),
    "smoothed": lambda picture: cv2.bilateralFilter(picture, 9, 30, 3),
    "16 grey levels": lambda picture: picture // 16 * 16 + 8,
}


@pytest.fixture(scope="module")
def plain():
    return [(item, render_picture(item.scene, item.seed)) for item in pictures("plain", 4, 77)]


@pytest.mark.parametrize("name", CHANGES)
def test_a_picture_that_was_processed_is_right_or_refused_for_it(name, plain, camera, layout):
    errors, reasons = [], []
    for item, picture in plain:
        scene = item.scene
        try:
            found = localize(CHANGES[name](picture), camera, layout, scene.width, item.thickness).offset
        except LocalizationError as refused:
            reasons.append(refused)
            continue
        errors.append(np.hypot(found.y - scene.offset.y, found.z - scene.offset.z))
    assert max(errors, default=0.0) < 0.03 * MM
    assert all(isinstance(one, ProcessedPicture) or "sharpening off" in one.message for one in reasons)


def test_grey_levels_far_apart_are_refused():
    shade = np.tile(np.linspace(20, 200, 400), (300, 1)).astype(np.uint8)
    check_levels(level_counts(shade))
    check_levels(level_counts(shade // 4 * 4))
    with pytest.raises(ProcessedPicture, match="16 apart, allowed are 6"):
        check_levels(level_counts(shade // 16 * 16))
