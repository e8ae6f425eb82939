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

    def points(self) -> FloatArray:
        """Inner corners on the board, row by row, shape (rows * columns, 3) [m]."""
        grid = np.zeros((self.rows * self.columns, 3))
        grid[:, :2] = np.mgrid[: self.columns, : self.rows].T.reshape(-1, 2) * self.square
        return grid


def find_corners(picture: ByteArray, board: Chessboard) -> FloatArray | None:
    """Inner corners in a grey picture (h, w), uint8: pixels (n, 2) in the board's order, or None.

    The sector-based detector finds boards that the older one misses; the gradient refinement after
    it halves its error.
    """
    shape = (board.columns, board.rows)
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(picture, shape, flags=flags)
    if not found:
        return None
    side = np.linalg.norm(np.diff(corners.reshape(board.rows, board.columns, 2), axis=1), axis=2).min()
    window = max(2, int(_WINDOW * side))
    refined = cv2.cornerSubPix(picture, corners.reshape(-1, 1, 2), (window, window), (-1, -1), _STOP)
    return np.asarray(refined.reshape(-1, 2), dtype=float)
