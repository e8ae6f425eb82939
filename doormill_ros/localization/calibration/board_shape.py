"""How a printed chessboard differs from the one that was drawn: not flat, stretched, skewed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.calibration.chessboard import Chessboard
from doormill_ros.localization.calibration.errors import BadCalibrationFile

# Standard deviations expected of a board before a picture was taken: what printers and cardboard do.
STRETCH = 3e-3  # of one axis against the other, and of the angle between them [rad]
_BOW = 5e-3  # height at the board's end, as a share of half its length
_WAVE = 2e-3  # the same of waves with three and four parts


@dataclass(frozen=True, eq=False)
class ShapeModel:
    """Linear parameters of a board's shape.

    Attributes:
        points: Inner corners of the drawn board about their middle, shape (n, 3) [m].
        by_parameter: Their derivatives, shape (m, n, 3) [m]; stretch of the columns and skew first, then heights.
        expected: Standard deviations of the parameters, shape (m,).
    """

    points: FloatArray
    by_parameter: FloatArray
    expected: FloatArray

    def bent(self, parameters: FloatArray) -> FloatArray:
        """Inner corners of the board with these parameters (m,), shape (n, 3) [m]."""
        return self.points + np.tensordot(parameters, self.by_parameter, axes=1)


def shape_model(board: Chessboard) -> ShapeModel:
    """Parameters that pictures of `board` can tell.

    Corners of a board that looks alike turned by half are numbered from either end: it has even parameters only.

    Raises:
        BadCalibrationFile: It is square.
    """
    refuse_square(board)
    points = board.points()
    points = points - points.mean(axis=0)
    half = float(np.abs(points).max())
    x, y = points[:, 0] / half, points[:, 1] / half
    flat = np.zeros_like(points)
    columns: list[FloatArray] = []
    expected: list[float] = []
    for across, along in ((1, points[:, 1]), (0, points[:, 1])):
        moved = flat.copy()
        moved[:, across] = along
        columns.append(moved)
        expected.append(STRETCH)
    for order in (2, 3, 4) if board.has_one_way_up else (2, 4):
        for i in range(order + 1):
            raised = flat.copy()
            raised[:, 2] = half * x ** (order - i) * y**i
            columns.append(raised)
            expected.append(_BOW if order == 2 else _WAVE)
    return ShapeModel(points, np.array(columns), np.array(expected))


def refuse_square(board: Chessboard) -> None:
    """Refuse a board that looks alike turned by a quarter: its corners are numbered from any of them.

    Which way it is bowed or stretched then cannot be told from pictures, and no scatter between them shows it.

    Raises:
        BadCalibrationFile: It has as many rows as columns.
    """
    if board.columns == board.rows:
        raise BadCalibrationFile(
            f"a board of {board.columns} x {board.rows} inner corners is given, allowed is one with more columns than "
            "rows or the other way round: turned by a quarter a square one looks alike, and its bow goes into the "
            f"focal length unseen; print one of {board.columns + 1} x {board.rows}"
        )


@dataclass(frozen=True, eq=False)
class BoardShape:
    """A board as the pictures have it.

    Attributes:
        stretch: By how much its columns are longer than drawn, its rows being right.
        stretch_deviation: Standard deviation.
        bow: Height between its lowest and its highest inner corner, measured from the plane through all [m].
        bow_deviation: Standard deviation [m].
    """

    stretch: float
    stretch_deviation: float
    bow: float
    bow_deviation: float


def board_shape(model: ShapeModel, parameters: FloatArray, covariance: FloatArray) -> BoardShape:
    """Read parameters (m,) and their covariance (m, m)."""
    plane = np.column_stack([model.points[:, :2], np.ones(len(model.points))])
    by_height = model.by_parameter[:, :, 2].T
    by_height = by_height - plane @ np.linalg.lstsq(plane, by_height, rcond=None)[0]
    height = by_height @ parameters
    ends = by_height[np.argmax(height)] - by_height[np.argmin(height)]
    deviation = float(np.sqrt(ends @ covariance @ ends))
    return BoardShape(
        float(parameters[0]), float(np.sqrt(covariance[0, 0])), float(np.ptp(height)), deviation
    )
