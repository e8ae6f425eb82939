"""A chessboard and its inner corners in a picture."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray

_WINDOW = 0.35  # half side of the refinement's window in squares: no other corner inside
_STOP = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-4)


@dataclass(frozen=True)
class Chessboard:
    """A flat chessboard.

    Attributes:
        columns: Inner corners along a row.
        rows: Inner corners along a column.
        square: Side of a square [m].
    """

    columns: int
    rows: int
    square: float

    @property
    def has_one_way_up(self) -> bool:
        """Whether turned by half it has black squares where white ones were."""
        return (self.columns + self.rows) % 2 == 1

    def points(self) -> FloatArray:
        """Inner corners on the board, row by row, shape (rows * columns, 3) [m]."""
        grid = np.zeros((self.rows * self.columns, 3))
        grid[:, :2] = np.mgrid[: self.columns, : self.rows].T.reshape(-1, 2) * self.square
        return grid


def find_corners(picture: ByteArray, board: Chessboard) -> FloatArray | None:
    """Inner corners in a grey picture (h, w), uint8: pixels (n, 2) in the board's order, or None.

    Where the colours tell which way up the board is, the square inside the first four corners is black. The
    sector-based detector finds boards that the older one misses; the gradient refinement after it halves its error.
    """
    shape = (board.columns, board.rows)
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(picture, shape, flags=flags)
    if not found:
        return None
    side = np.linalg.norm(np.diff(corners.reshape(board.rows, board.columns, 2), axis=1), axis=2).min()
    window = max(2, int(_WINDOW * side))
    refined = cv2.cornerSubPix(picture, corners.reshape(-1, 1, 2), (window, window), (-1, -1), _STOP)
    found_at = np.asarray(refined.reshape(-1, 2), dtype=float)
    upside_down = board.has_one_way_up and not _begins_black(picture, found_at, board)
    return found_at[::-1].copy() if upside_down else found_at


def _begins_black(picture: ByteArray, corners: FloatArray, board: Chessboard) -> bool:
    """Whether the square inside the first four corners is darker than the one beside it."""
    grid = corners.reshape(board.rows, board.columns, 2)
    middles = [grid[:2, i : i + 2].reshape(4, 2).mean(axis=0) for i in (0, 1)]
    patches = [cv2.getRectSubPix(picture, (3, 3), (float(x), float(y))) for x, y in middles]
    return float(np.mean(patches[0])) < float(np.mean(patches[1]))
