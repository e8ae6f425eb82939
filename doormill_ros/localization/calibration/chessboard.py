"""A chessboard and its inner corners in a picture."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np


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

    def points(self) -> np.ndarray:
        """Inner corners on the board, row by row, shape (rows * columns, 3) [m]."""
        grid = np.zeros((self.rows * self.columns, 3))
        grid[:, :2] = np.mgrid[: self.columns, : self.rows].T.reshape(-1, 2) * self.square
        return grid


def find_corners(picture: np.ndarray, board: Chessboard) -> np.ndarray | None:
    """Inner corners in a grey picture (h, w), uint8: pixels (n, 2) in the board's order, or None.

    The sector-based detector fits a saddle to each corner and needs no refinement afterwards.
    """
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(picture, (board.columns, board.rows), flags=flags)
    if not found:
        return None
    return corners.reshape(-1, 2).astype(float)
