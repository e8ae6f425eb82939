"""The thesis' camera matrix and distortion (section 3.7, eq. 3.43) examined."""

import cv2
import numpy as np
import pytest

from doormill_ros.localization.calibration.intrinsics import calibrate_intrinsics
from doormill_ros.localization.calibration.lens_check import check_lens, distorted_radius, fold_radius
from doormill_ros.localization.camera import load_camera
from support.pictures.chessboard_corners import BOARD, held_upright

THESIS_K = np.array([[1678.35, 0.0, 946.41], [0.0, 1727.22, 510.71], [0.0, 0.0, 1.0]])
THESIS_DISTORTION = (0.0206, 10.4073, -115.4536)
SIZE = (1920, 1080)
SQUARE_PIXELS = np.array([[1700.0, 0.0, 950.0], [0.0, 1700.0, 520.0], [0.0, 0.0, 1.0]])


def test_read_as_radial_coefficients_they_fold_the_picture():
    found = check_lens(THESIS_K, SIZE, THESIS_DISTORTION)
    # By hand: 1 + 0.0618 s + 52.04 s^2 - 808.2 s^3 = 0 has its root at s = 0.134.
    assert found.fold == pytest.approx(0.366, abs=0.001)
    assert found.reach < 0.34 < found.corner
    assert 0.45 < found.blind_share < 0.60  # half of the picture has no ray of its own
    assert found.corner_shift < -5000  # px, through the centre and out on the other side


def test_the_fold_agrees_with_opencv():
    r = np.linspace(0.0, 0.5, 2001)
    points = np.column_stack([r, np.zeros_like(r), np.ones_like(r)])
    k1, k2, k3 = THESIS_DISTORTION
    seen = cv2.projectPoints(points, np.zeros(3), np.zeros(3), np.eye(3), np.array([k1, k2, 0, 0, k3]))[0][
        :, 0, 0
    ]
    np.testing.assert_allclose(seen, distorted_radius(r, THESIS_DISTORTION), atol=1e-12)
    assert r[np.argmax(seen)] == pytest.approx(fold_radius(THESIS_DISTORTION), abs=5e-4)


@pytest.mark.parametrize(
    "radial", [(0.0, 0.0, 1e-310), (-1.0, 0.0, 1e-310), (0.0, 1e-200, 0.0), (0.0, 0.0, 0.0)]
)
def test_coefficients_of_next_to_nothing_are_nothing(radial):
    expected = fold_radius((radial[0], 0.0, 0.0))
    assert fold_radius(radial) == pytest.approx(expected)


def test_every_other_order_is_worse():
    k1, k2, k3 = THESIS_DISTORTION
    for order in ((k3, k2, k1), (k2, k1, k3), (k1, k3, k2), (k2, k3, k1), (k3, k1, k2)):
        found = check_lens(THESIS_K, SIZE, order)
        assert found.usable < 0.12  # against 0.33 as k1, k2, k3
        assert found.blind_share > 0.53 or abs(found.corner_shift) > 5000
    # As k1, k2, p1 of OpenCV a ray 0.1 below the centre is moved by more than the picture is high.
    points = np.array([[0.0, 0.1, 1.0]])
    seen = cv2.projectPoints(points, np.zeros(3), np.zeros(3), THESIS_K, np.array([k1, k2, k3, 0.0]))[0][0, 0]
    assert abs(seen[1] - (510.71 + 172.7)) > 1080


def test_near_the_middle_they_are_harmless():
    """Below r = 0.3 the three terms nearly cancel: less than 1.5 %, where the chessboard was."""
    r = np.linspace(0.01, 0.3, 100)
    share = distorted_radius(r, THESIS_DISTORTION) / r - 1
    assert 0.010 < share.max() < 0.015
    assert share.min() > 0


def test_the_shipped_lens_never_folds():
    camera = load_camera()
    found = check_lens(
        camera.k, camera.size, (camera.distortion[0], camera.distortion[1], camera.distortion[4])
    )
    assert found.fold == float("inf")
    assert found.blind_share == 0.0


def test_focal_lengths_of_square_pixels_would_differ_by_less():
    ratio = THESIS_K[0, 0] / THESIS_K[1, 1]
    assert ratio == pytest.approx(0.9717, abs=1e-4)
    # A 10 mm move at the thesis' 0.1 mm per pixel would differ by 0.28 mm between the axes,
    # though the thesis expects the same number of pixels in both.
    assert abs(1 - ratio) * 10 == pytest.approx(0.28, abs=0.01)


def test_a_stretched_print_gives_the_thesis_ratio_with_square_pixels():
    """A board printed 2.9 % too narrow, held upright: small residual error, fx / fy = 0.972."""
    ratios, errors, ours = [], [], []
    body = BOARD.points().astype(np.float32)
    for seed in range(5):
        corners = held_upright(19, seed, SQUARE_PIXELS, (THESIS_K[0, 0] / THESIS_K[1, 1], 1.0))
        # As the thesis did, with a board taken for what was drawn.
        error, k = cv2.calibrateCamera(
            [body] * 19, [c.astype(np.float32) for c in corners], SIZE, None, None
        )[:2]
        ratios.append(k[0, 0] / k[1, 1])
        errors.append(error)
        ours.append(calibrate_intrinsics(corners, BOARD, SIZE, radial=3))
    assert np.mean(ratios) == pytest.approx(0.9717, abs=0.002)
    assert max(errors) < 0.5
    assert np.mean([f.k[0, 0] / f.k[1, 1] for f in ours]) == pytest.approx(1.0, abs=0.005)
    assert np.mean([f.shape.stretch for f in ours]) == pytest.approx(0.029, abs=0.005)
    straight = calibrate_intrinsics(held_upright(19, 1, SQUARE_PIXELS), BOARD, SIZE, radial=3)
    unsure = straight.shape.stretch_deviation
    assert unsure < 2e-3
    assert straight.k[0, 0] / straight.k[1, 1] == pytest.approx(1.0, abs=3 * unsure)


def test_a_board_in_the_middle_gives_such_coefficients_without_any_distortion():
    """Three radial terms on corners below r = 0.25: noise of 0.1 px is answered with tens and hundreds."""
    found = [
        calibrate_intrinsics(held_upright(19, s, SQUARE_PIXELS, distance=(0.8, 1.6)), BOARD, SIZE, radial=3)
        for s in range(8)
    ]
    k2, k3 = (np.array([f.distortion[i] for f in found]) for i in (1, 4))
    assert max(f.covered for f in found) < 0.35
    assert np.abs(k2).max() > 1
    assert np.abs(k3).max() > 20
    assert np.corrcoef(k2, k3)[0, 1] < -0.7  # they pay for each other, as the thesis' two do
    assert np.median([f.distortion_deviation[4] for f in found]) > 10  # and the calibration says so
