"""Board pictures of no use, each refused with its reason; which views a set lacks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from doormill_ros.localization.calibration.board_view import BoardPicture, judge
from doormill_ros.localization.calibration.chessboard import Chessboard
from doormill_ros.localization.calibration.coverage import PLENTY, coverage, draw_coverage
from doormill_ros.simulation.picture.scene import Sensor
from support.pictures.chessboard import render_chessboard
from support.pictures.uneven_boards import Session, session

BOARD = Chessboard(9, 6, 0.020)
SIZE = (640, 360)


@pytest.fixture(scope="module")
def truth() -> Session:
    return session(0)


@pytest.fixture(scope="module")
def good(truth: Session) -> np.ndarray:
    return render_chessboard(truth.camera, truth.views[0], Sensor(blur=0.8), 1)


def box(truth: Session) -> tuple[int, int, int, int]:
    corners = truth.views[0].true_corners(truth.camera)
    return (*corners.min(axis=0).astype(int), *corners.max(axis=0).astype(int))


def test_a_good_picture_is_taken(truth: Session, good: np.ndarray) -> None:
    view = judge(good, "a.png", BOARD)
    assert view.reason == ""
    assert view.corners is not None
    assert np.abs(view.corners - truth.views[0].true_corners(truth.camera)).max() < 0.3


def smeared(picture: np.ndarray) -> np.ndarray:
    return cv2.blur(picture, (9, 1))


@pytest.mark.parametrize(
    "spoil", [lambda p: cv2.GaussianBlur(p, (0, 0), 3), smeared], ids=["out of focus", "moved sideways"]
)
def test_a_blurred_one_is_refused(good: np.ndarray, spoil: Callable[[np.ndarray], np.ndarray]) -> None:
    view = judge(spoil(good), "a.png", BOARD)
    assert view.corners is None
    assert view.reason.startswith("blurred: edges rise over ")


def test_a_board_that_leaves_the_picture_is_refused(truth: Session, good: np.ndarray) -> None:
    x0, _, x1, _ = box(truth)
    cut = np.ascontiguousarray(good[:, x0 + (x1 - x0) // 3 :])
    assert judge(cut, "a.png", BOARD).reason.startswith("the board is only partly seen: ")


@pytest.mark.parametrize("size", [(8, 6), (7, 5)])
def test_another_board_is_told_with_its_size(good: np.ndarray, size: tuple[int, int]) -> None:
    reason = judge(good, "a.png", Chessboard(*size, 0.02)).reason
    assert reason.startswith(
        f"a board of 9 x 6 inner corners, {size[0]} x {size[1]} are expected; give --board"
    )


def test_the_same_view_again_is_refused_and_names_the_first(truth: Session, good: np.ndarray) -> None:
    first = judge(good, "a.png", BOARD)
    again = render_chessboard(truth.camera, truth.views[0], Sensor(blur=0.8), 2)
    assert judge(again, "b.png", BOARD, [first]).reason.startswith("the same view as a.png")
    x, y, far = truth.views[0].place
    moved = render_chessboard(
        truth.camera, replace(truth.views[0], place=(x, y, 1.1 * far)), Sensor(blur=0.8), 3
    )
    assert judge(moved, "c.png", BOARD, [first]).reason == ""
    assert judge(again, "b.png", BOARD, [BoardPicture("x.png", None, "blurred")]).reason == ""


def test_no_board_is_no_board() -> None:
    assert judge(np.full(SIZE[::-1], 90, np.uint8), "a.png", BOARD).reason.startswith("no board found")


def test_missing_views_become_fewer_until_none_is_left() -> None:
    truth = session(24)
    corners = truth.corners(24, 0.05)
    counts = [len(coverage(corners[:n], BOARD, SIZE).missing) for n in (0, 1, 4, 8, len(corners))]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] >= 12 + 4  # every field, every tilt
    assert counts[-1] == 0
    assert coverage(corners[:4], BOARD, SIZE).missing[0] == f"{PLENTY - 4} more pictures"


def test_upright_boards_lack_the_quarter_turn() -> None:
    upright = session(8)
    assert upright.hold == "upright"
    missing = coverage(upright.corners(8, 0.05), BOARD, SIZE).missing
    assert any("turned by a quarter" in sentence for sentence in missing)


def test_tilts_are_told_by_the_side_that_is_nearer() -> None:
    truth = session(0)
    for turn, side in (
        ((0.0, 0.5, 0.0), "right"),
        ((0.0, -0.5, 0.0), "left"),
        ((0.5, 0.0, 0.0), "upper"),
        ((-0.5, 0.0, 0.0), "lower"),
    ):
        view = replace(truth.views[0], turn=turn, place=(0.0, 0.0, 0.3), bend=0.0)
        depth = (
            view.place[2]
            + np.cross(turn, [0.1, 0.0, 0.0] if side in ("left", "right") else [0.0, 0.1, 0.0])[2]
        )
        positive = side in ("right", "lower")
        assert (depth < view.place[2]) == positive  # the side of growing coordinates is the nearer one
        missing = coverage([view.true_corners(truth.camera)], BOARD, SIZE).missing
        tilts = [s for s in missing if "tilted" in s]
        assert len(tilts) == 3
        assert not any(f"its {side} side" in s for s in tilts)


def test_the_picture_of_the_coverage_shows_what_is_bare() -> None:
    corners = np.column_stack([np.linspace(10, 150, 54), np.linspace(10, 110, 54)])
    grid = session(0).views[0].true_corners(session(0).camera)
    seen = coverage([grid * 0.2 + corners.min(axis=0)], BOARD, SIZE)
    drawn = draw_coverage(seen)
    assert drawn.shape == (SIZE[1], SIZE[0], 3)
    assert drawn[300, 600].tolist() != [255, 255, 255]  # bare
    x, y = np.rint(seen.corners[20]).astype(int)
    assert drawn[y, x, 1] < 150
