"""Pictures of a chessboard held before the camera, as for a calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.simulation.picture.optics import bin_down, expose, lens, rays, spread
from doormill_ros.simulation.picture.scene import SceneCamera, Sensor

_FINE = 3  # sub-pixels along each axis
_MARGIN = 1.0  # squares of white around the pattern
_WALL = 0.35


@dataclass(frozen=True)
class BoardView:
    """One picture of a board of (columns + 1) x (rows + 1) squares.

    Attributes:
        columns: Inner corners along a row.
        rows: Inner corners along a column.
        square: Side of a square [m].
        turn: Rotation vector of the board in camera axes [rad].
        place: Middle of the inner corners in camera axes [m].
        bend: Height by which the board's left and right ends curl up from its middle [m].
        bow: The same of its upper and lower ends [m].
        twist: Height of two opposite corners of the pattern, the others being as much lower [m].
        corner: Height of the first corner of the pattern, curled up alone [m].
        stretch: By how much its columns are longer than drawn.
        skew: By how much the columns lean along the rows [rad].
    """

    columns: int
    rows: int
    square: float
    turn: tuple[float, float, float]
    place: tuple[float, float, float]
    bend: float = 0.0
    bow: float = 0.0
    twist: float = 0.0
    corner: float = 0.0
    stretch: float = 0.0
    skew: float = 0.0

    def true_corners(self, camera: SceneCamera) -> np.ndarray:
        """Where the inner corners are in the picture, row by row, shape (n, 2) [px]."""
        x, y = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        x = (x.ravel() - (self.columns - 1) / 2) * self.square
        y = (y.ravel() - (self.rows - 1) / 2) * self.square
        y = y * (1.0 + self.stretch)
        x = x + self.skew * y
        body = np.column_stack([x, y, -self._height(x, y)])
        points = body @ Rotation.from_rotvec(self.turn).as_matrix().T + self.place
        seen = lens(points[:, :2] / points[:, 2:], camera.brown)
        return seen @ camera.matrix[:2, :2].T + camera.matrix[:2, 2]

    def _height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        a, b = 2.0 * x / (self.columns * self.square), 2.0 * y / (self.rows * self.square)
        curled = np.maximum(-(a + b) / 2.0 - 0.2, 0.0) / 0.8
        return self.bend * a**2 + self.bow * b**2 + self.twist * a * b + self.corner * curled**2

    def is_flat(self) -> bool:
        return not (self.bend or self.bow or self.twist or self.corner)


def calibration_views(
    count: int,
    columns: int = 9,
    rows: int = 6,
    square: float = 0.020,
    seed: int = 0,
    bad: int | None = None,
    focal: tuple[float, float] = (1678.35, 1727.22),
    size: tuple[int, int] = (1920, 1080),
) -> list[BoardView]:
    """Views as a careful person takes them: near and far, tilted all ways, all over the picture.

    Args:
        count: How many.
        columns: Inner corners along a row.
        rows: Inner corners along a column.
        square: Side of a square [m].
        seed: Draws the views.
        bad: Which of them shows the board bent by 4 mm, or None.
        focal: Focal lengths of the camera [px], to fill its picture.
        size: Its picture width and height [px].
    """
    rng, views = np.random.default_rng(seed), []
    field = np.array(size) / np.array(focal)
    extent = np.array([columns + 1, rows + 1]) * square
    for i in range(count):
        share = rng.uniform(0.45, 0.75)  # of the picture that the board fills
        distance = float(np.max(extent / field)) / share
        tilt = rng.uniform(0.25, 0.6)
        way = rng.uniform(0, 2 * np.pi)
        turn = Rotation.from_rotvec([0, 0, rng.uniform(-0.3, 0.3)])
        turn = Rotation.from_rotvec([tilt * np.cos(way), tilt * np.sin(way), 0]) * turn
        room = np.maximum(field * distance - extent * 1.08, 0.0) / 2
        middle = rng.uniform(-1, 1, 2) * room
        views.append(
            BoardView(
                columns,
                rows,
                square,
                tuple(turn.as_rotvec()),
                (*middle, distance),
                bend=0.004 if i == bad else 0.0,
            )
        )
    return views


def render_chessboard(camera: SceneCamera, view: BoardView, sensor: Sensor, seed: int) -> np.ndarray:
    """The picture (h, w), uint8."""
    rng = np.random.default_rng(seed)
    rows, columns = camera.shape
    x, y = rays(camera, (0, rows, 0, columns), _FINE)
    look = Rotation.from_rotvec(view.turn).as_matrix()
    eye = -np.array(view.place) @ look  # projection centre in board axes
    look = look.T.astype(np.float32)
    ahead = [look[i, 0] * x + look[i, 1] * y + look[i, 2] for i in range(3)]
    height = np.float32(0.0)
    for _ in range(1 if view.is_flat() else 4):  # the bent board is met by a few corrections of the flat one
        reach = (height - np.float32(eye[2])) / ahead[2]
        a, b = eye[0] + reach * ahead[0], eye[1] + reach * ahead[1]
        height = -view._height(a, b)
    b = b / (1.0 + view.stretch)
    a = a - view.skew * b * (1.0 + view.stretch)
    a, b = a / view.square + (view.columns + 1) / 2, b / view.square + (view.rows + 1) / 2
    black = (np.floor(a).astype(np.int32) + np.floor(b).astype(np.int32)) % 2 == 0
    pattern = (a > 0) & (a < view.columns + 1) & (b > 0) & (b < view.rows + 1)
    paper = (a > -_MARGIN) & (a < view.columns + 1 + _MARGIN) & (b > -_MARGIN) & (b < view.rows + 1 + _MARGIN)
    level = np.where(paper, np.float32(0.8), np.float32(_WALL))
    level[pattern & black] = 0.08
    light = 1.0 + rng.uniform(-0.15, 0.15) * x + rng.uniform(-0.15, 0.15) * y
    return expose(bin_down(spread(level * light.astype(np.float32), sensor, _FINE), _FINE), sensor, rng)
