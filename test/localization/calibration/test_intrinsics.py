"""Chessboard calibration: pictures back to the camera, bad pictures out, honest uncertainties."""

import cv2
import numpy as np
import pytest

from doormill_ros.localization.calibration.chessboard import Chessboard, find_corners
from doormill_ros.localization.calibration.errors import BadCalibrationFile, PoorlySpread, TooFewPictures
from doormill_ros.localization.calibration.intrinsics import calibrate_intrinsics, check_corner
from doormill_ros.simulation.picture.scene import Sensor
from support.pictures.chessboard import render_chessboard
from support.pictures.chessboard_corners import (
    BOARD,
    CAMERA,
    SIZE,
    TRUE_DISTORTION,
    TRUE_K,
    held_upright,
    noisy_corners,
    views,
)

TRUE = np.array([TRUE_K[0, 0], TRUE_K[1, 1], TRUE_K[0, 2], TRUE_K[1, 2], *TRUE_DISTORTION[:4]])
BENT = 4


def values(found):
    k = found.k
    numbers = np.array([k[0, 0], k[1, 1], k[0, 2], k[1, 2], *found.distortion[:4]])
    return numbers, np.concatenate([found.k_deviation, found.distortion_deviation[:4]])


@pytest.fixture(scope="module")
def rendered():
    """(view, corners found in its picture); one board is bent."""
    return [
        (view, find_corners(render_chessboard(CAMERA, view, Sensor(blur=0.8), i), BOARD))
        for i, view in enumerate(views(10, seed=3, bad=BENT))
    ]


def test_corners_are_found_to_a_fraction_of_a_pixel(rendered):
    assert len(rendered) == 10
    for view, corners in rendered:
        true = view.true_corners(CAMERA)
        turned = true[::-1]  # a board looks alike upside down
        off = min(np.abs(corners - true).max(), np.abs(corners - turned).max())
        assert off < 0.2
        rms = min(np.sqrt(np.mean((corners - t) ** 2)) for t in (true, turned))
        assert rms < 0.06


def test_the_camera_comes_back_from_pictures_and_the_bent_board_is_left_out(rendered):
    found = calibrate_intrinsics([c for _, c in rendered], BOARD, SIZE)
    assert list(np.flatnonzero(~found.used)) == [BENT]
    assert found.picture_error[BENT] > 5 * np.median(found.picture_error)
    numbers, deviations = values(found)
    assert np.all(np.abs(numbers - TRUE) < 5 * deviations)
    assert np.all(np.abs(numbers[:2] - TRUE[:2]) < 2e-3 * TRUE[:2])
    assert found.error < 0.06


def test_keeping_the_bent_board_would_hurt(rendered):
    """The rejection matters: by itself the bent board moves the focal length beyond its uncertainty."""
    clean = calibrate_intrinsics([c for _, c in rendered], BOARD, SIZE)
    body, seen = BOARD.points().astype(np.float32), [c.astype(np.float32) for _, c in rendered]
    kept = cv2.calibrateCamera([body] * len(seen), seen, SIZE, None, None, flags=cv2.CALIB_FIX_K3)
    assert abs(kept[1][0, 0] - TRUE[0]) > abs(clean.k[0, 0] - TRUE[0])
    assert kept[0] > 2 * clean.error


def test_stated_deviations_are_those_of_repeated_calibrations():
    normalised = []
    for seed in range(25):
        numbers, deviations = values(calibrate_intrinsics(noisy_corners(10, seed, 0.05), BOARD, SIZE))
        normalised.append((numbers - TRUE) / deviations)
    spread = np.sqrt(np.mean(np.square(normalised), axis=0))
    # 25 draws: the root of chi-square over its 25 lies in 0.58 .. 1.45 with 99.9 %.
    assert np.all(spread > 0.55), spread
    assert np.all(spread < 1.5), spread


def test_good_pictures_all_stay():
    dropped = sum(
        (~calibrate_intrinsics(noisy_corners(20, s, 0.05), BOARD, SIZE).used).sum() for s in range(10)
    )
    assert dropped <= 2  # of 200


def test_several_bad_pictures_go_and_a_board_not_found_is_told():
    corners = noisy_corners(14, 5, 0.05)
    rng = np.random.default_rng(1)
    for bad in (2, 9):
        corners[bad] = corners[bad] + rng.normal(0, 1.0, (54, 2))
    corners[4] = None
    found = calibrate_intrinsics(corners, BOARD, SIZE)
    assert list(np.flatnonzero(~found.used)) == [2, 4, 9]
    assert np.isnan(found.picture_error[4])
    assert min(found.picture_error[[2, 9]]) > 0.5


def test_an_empty_picture_has_no_board():
    assert find_corners(np.full((200, 300), 120, np.uint8), BOARD) is None
    assert Chessboard(3, 2, 0.01).points()[-1] == pytest.approx([0.02, 0.01, 0.0])


def test_too_few_pictures_are_refused():
    with pytest.raises(TooFewPictures, match="2 of 3"):
        calibrate_intrinsics([*noisy_corners(2, 1, 0.05), None], BOARD, SIZE)


def test_deviations_are_no_smaller_than_those_of_a_board_known_to_be_flat():
    """OpenCV takes the board for what was drawn: not knowing that costs something, but no multiple."""
    corners = noisy_corners(12, 3, 0.05)
    found = calibrate_intrinsics(corners, BOARD, SIZE)
    assert found.used.all()
    body, seen = BOARD.points().astype(np.float32), [c.astype(np.float32) for c in corners]
    flags = cv2.CALIB_FIX_K3
    theirs = cv2.calibrateCameraExtended([body] * 12, seen, SIZE, None, None, flags=flags)[5].ravel()
    ratio = np.concatenate([found.k_deviation, found.distortion_deviation[:4]]) / theirs[:8]
    assert np.all(ratio > 0.98), ratio
    assert np.all(ratio < 3.0), ratio
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance))[:4], found.k_deviation)


def test_a_square_board_is_refused():
    """Turned by a quarter it looks alike: a bow would go into the focal length with next to no deviation."""
    with pytest.raises(
        BadCalibrationFile, match=r"a board of 7 x 7 inner corners is given, .* print one of 8 x 7"
    ):
        calibrate_intrinsics([None] * 8, Chessboard(7, 7, 0.02), SIZE)


def test_a_lens_that_was_seen_in_the_middle_only_is_not_known_in_the_corner():
    square = np.array([[1700.0, 0.0, 950.0], [0.0, 1700.0, 520.0], [0.0, 0.0, 1.0]])
    corners = held_upright(19, 2, square, distance=(0.8, 1.6))
    open_corner = calibrate_intrinsics(corners, BOARD, (1920, 1080), radial=3)
    assert abs(open_corner.distortion[4]) > 5
    with pytest.raises(
        PoorlySpread, match=r"where a ray to the picture's corner lands, by \d+ px, allowed are 3\d px"
    ):
        check_corner(open_corner)


@pytest.mark.parametrize("seed", range(4))
def test_a_lens_that_was_seen_all_over_is_known_in_the_corner(seed):
    check_corner(calibrate_intrinsics(noisy_corners(10, seed, 0.05), BOARD, SIZE))


@pytest.mark.parametrize("seed", range(6))
def test_a_board_never_tilted_is_refused(seed):
    """Seen square on from one distance a board leaves focal length and distance open."""
    flat = BOARD.points()[:, :2] * 3000 + [300, 150]
    rng = np.random.default_rng(seed)
    corners = [flat + rng.uniform(-40, 40, 2) + rng.normal(0, 0.05, flat.shape) for _ in range(8)]
    with pytest.raises(PoorlySpread, match="tilted"):
        calibrate_intrinsics(corners, BOARD, SIZE)
