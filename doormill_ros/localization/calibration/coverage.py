"""Which views a set of board pictures has, and which are still missing.

A board nearer on one side shows as a plane whose inverse distance grows across the picture: the third row of the
homography from picture to board is that growth, without any knowledge of the camera.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.calibration.chessboard import Chessboard

COLUMNS, ROWS = 4, 3  # fields of the picture
_PART = 0.04  # share of all corners of one picture that a field needs
_TILT = 0.08  # growth of the inverse distance across the board that counts as tilted
_NEAR = 0.5  # share of the picture's width that a near board has
_SIZES = 1.3  # least ratio of the largest board's width to the smallest's
_QUARTER = np.pi / 4
PLENTY = 12  #: pictures
_ABOVE = {0: "at the top", ROWS - 1: "at the bottom"}
_BESIDE = {0: "left", COLUMNS - 1: "right"}


@dataclass(frozen=True, eq=False)
class Coverage:
    """What the pictures show.

    Attributes:
        fields: Corners in each field of the picture, shape (ROWS, COLUMNS).
        missing: Views that are missing, one sentence each; empty when none is.
        corners: All corners, shape (n, 2) [px].
        size: Picture width and height [px].
    """

    fields: FloatArray
    missing: tuple[str, ...]
    corners: FloatArray
    size: tuple[int, int]


def coverage(seen: Sequence[FloatArray], board: Chessboard, size: tuple[int, int]) -> Coverage:
    """Examine the corners (n, 2) [px] of usable pictures of width and height `size`."""
    corners = np.concatenate([np.zeros((0, 2)), *seen])
    fields = np.histogram2d(
        corners[:, 1], corners[:, 0], bins=(ROWS, COLUMNS), range=((0, size[1]), (0, size[0]))
    )[0]
    missing = [] if len(seen) >= PLENTY else [f"{PLENTY - len(seen)} more pictures"]
    bare = fields < _PART * board.columns * board.rows
    missing += [f"the board {_place(*where)} of the picture" for where in np.argwhere(bare)]
    growths = np.array([_growth(c, board) for c in seen]).reshape(-1, 2)
    for axis, sign, side in ((0, -1, "left"), (0, 1, "right"), (1, -1, "upper"), (1, 1, "lower")):
        if not np.any(sign * growths[:, axis] > _TILT):
            missing.append(f"the board tilted, its {side} side nearer")
    widths = np.array([_width(c, size) for c in seen])
    if not np.any(widths > _NEAR):
        missing.append("the board near, as wide as half the picture")
    if len(seen) and widths.max() < _SIZES * widths.min():
        missing.append("the board further away than in the others")
    turns = np.array([_turn(c, board) for c in seen])
    if not np.any(turns > _QUARTER) or not np.any(turns <= _QUARTER):
        missing.append(
            "the board turned by a quarter: a board stretched by the printer looks like unequal focal lengths"
        )
    return Coverage(fields, tuple(missing), corners, size)


def draw_coverage(found: Coverage) -> ByteArray:
    """A picture, shape (h, w, 3), rgb, uint8: every corner, bare fields in red."""
    width, height = found.size
    drawn = np.full((height, width, 3), 255, np.uint8)
    needed = np.array(found.fields) > 0
    for (row, column), some in np.ndenumerate(needed):
        left, right = (round(width * (column + i) / COLUMNS) for i in (0, 1))
        top, bottom = (round(height * (row + i) / ROWS) for i in (0, 1))
        if not some:
            drawn[top:bottom, left:right] = (240, 170, 160)
        cv2.rectangle(drawn, (left, top), (right - 1, bottom - 1), (150, 150, 150), 1)
    dot = max(1, width // 300)
    for x, y in found.corners:
        cv2.circle(drawn, (round(float(x)), round(float(y))), dot, (20, 110, 40), -1)
    return drawn


def _place(row: int, column: int) -> str:
    above, beside = _ABOVE.get(row), _BESIDE.get(column)
    if above and beside:
        return f"{above} {beside}"
    return above or beside or "in the middle"


def _growth(corners: FloatArray, board: Chessboard) -> FloatArray:
    """By which share the inverse distance grows across the board, along the picture's x and y, shape (2,)."""
    middle = corners.mean(axis=0)
    homography, _ = cv2.findHomography(corners - middle, board.points()[:, :2] / board.square)
    extent: FloatArray = np.ptp(corners, axis=0)
    growth: FloatArray = homography[2, :2] / homography[2, 2] * extent
    return growth


def _width(corners: FloatArray, size: tuple[int, int]) -> float:
    return float(np.max(np.ptp(corners, axis=0) / size))


def _turn(corners: FloatArray, board: Chessboard) -> float:
    """Angle between the board's rows and the picture's, 0 to pi / 2."""
    grid = corners.reshape(board.rows, board.columns, 2)
    x, y = np.abs(np.mean(grid[:, -1] - grid[:, 0], axis=0))
    return float(np.arctan2(y, x))
