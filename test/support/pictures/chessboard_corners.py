"""Chessboard corners without pictures, for statistics over many calibrations."""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.localization.calibration.chessboard import Chessboard
from doormill_ros.simulation.picture.scene import SceneCamera
from support.pictures.chessboard import calibration_views

BOARD = Chessboard(9, 6, 0.020)
SIZE = (960, 540)
TRUE_K = np.array([[839.2, 0.0, 473.2], [0.0, 863.6, 255.4], [0.0, 0.0, 1.0]])  # eq. 3.43, halved
TRUE_DISTORTION = np.array([-0.080, 0.050, 0.0003, -0.0002, 0.0])
CAMERA = SceneCamera(TRUE_K, TRUE_DISTORTION, SIZE[::-1], np.zeros(3))


def views(count: int, seed: int, bad: int | None = None) -> list:
    """Views that fill the half-size picture."""
    return calibration_views(count, seed=seed, bad=bad, focal=(TRUE_K[0, 0], TRUE_K[1, 1]), size=SIZE)


def noisy_corners(count: int, seed: int, noise: float) -> list[np.ndarray]:
    """Corners of `views` with independent errors [px]."""
    rng = np.random.default_rng([seed, 1])
    return [v.true_corners(CAMERA) + rng.normal(0, noise, (54, 2)) for v in views(count, seed)]


def held_upright(
    count: int,
    seed: int,
    k: np.ndarray,
    stretch: tuple[float, float] = (1.0, 1.0),
    distance: tuple[float, float] = (0.5, 1.0),
    noise: float = 0.1,
) -> list[np.ndarray]:
    """Corners of a board near the middle of a picture by a lens without distortion.

    Args:
        count: How many pictures.
        seed: Draws the poses and the errors.
        k: Camera matrix.
        stretch: Factors by which the printer stretched the board along its rows and columns.
        distance: Nearest and farthest board [m].
        noise: Error of a corner [px].
    """
    rng, out = np.random.default_rng(seed), []
    body = BOARD.points() * [*stretch, 1.0]
    body -= body.mean(axis=0)
    for _ in range(count):
        far, way, tilt = rng.uniform(*distance), rng.uniform(0, 2 * np.pi), rng.uniform(0.1, 0.5)
        turn = cv2.Rodrigues(np.array([tilt * np.cos(way), tilt * np.sin(way), 0.0]))[0]
        turn = turn @ cv2.Rodrigues(np.array([0.0, 0.0, rng.normal(0, 0.1)]))[0]
        points = body @ turn.T + [rng.uniform(-0.1, 0.1) * far, rng.uniform(-0.05, 0.05) * far, far]
        seen = (points / points[:, 2:]) @ k.T
        out.append(seen[:, :2] + rng.normal(0, noise, (len(points), 2)))
    return out
