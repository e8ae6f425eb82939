"""Calibrations with boards that are not what was drawn: bowed, twisted, stretched, held in few ways."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.simulation.picture.scene import SceneCamera, Sensor
from support.pictures.chessboard import BoardView, calibration_views, render_chessboard

#: Which shape a board has and how it is held; sizes of a shape in metres, or as shares.
SHAPES: dict[str, dict[str, float]] = {
    "flat": {},
    "bowed along": {"bend": 3e-4},
    "bowed across": {"bow": -3e-4},
    "twisted": {"twist": 3e-4},
    "corner up": {"corner": 4e-4},
    "stretched": {"stretch": 3e-3},
    "stretched and bowed": {"stretch": -3e-3, "bend": -3e-4},
    "skewed": {"skew": 2e-3},
}
HOLDS = ("turned", "upright", "few", "soft")


@dataclass(frozen=True, eq=False)
class Session:
    """The pictures of one calibration.

    Attributes:
        shape: Key of `SHAPES`.
        hold: "turned" has quarter turns among 14 pictures, "upright" none, "few" 8 pictures, "soft" is out of focus.
        camera: The true camera, another in each session.
        views: What was held before it.
        blur: Of the optics [px].
    """

    shape: str
    hold: str
    camera: SceneCamera
    views: list[BoardView]
    blur: float

    @property
    def true(self) -> np.ndarray:
        """fx, fy, cx, cy, k1, k2, p1, p2."""
        k = self.camera.matrix
        return np.array([k[0, 0], k[1, 1], k[0, 2], k[1, 2], *self.camera.brown[:4]])

    def pictures(self, seed: int) -> list[np.ndarray]:
        """Rendered, each (h, w), uint8."""
        sensor = Sensor(blur=self.blur)
        return [render_chessboard(self.camera, v, sensor, 1000 * seed + i) for i, v in enumerate(self.views)]

    def corners(self, seed: int, noise: float) -> list[np.ndarray]:
        """What a perfect finder with independent errors [px] finds, without rendering."""
        rng = np.random.default_rng([seed, 7])
        found = [v.true_corners(self.camera) for v in self.views]
        return [c + rng.normal(0, noise, c.shape) for c in found]


def session(seed: int, size: tuple[int, int] = (640, 360)) -> Session:
    """The `seed`th of all shapes and holds in turn; 32 have each once."""
    rng = np.random.default_rng([seed, 3])
    shape = list(SHAPES)[seed % len(SHAPES)]
    hold = HOLDS[seed // len(SHAPES) % len(HOLDS)]
    focal = size[0] * rng.uniform(0.8, 1.1)
    matrix = np.array(
        [
            [focal, 0.0, size[0] / 2 + rng.normal(0, 8)],
            [0.0, focal * (1.0 + rng.normal(0, 2e-3)), size[1] / 2 + rng.normal(0, 8)],
            [0.0, 0.0, 1.0],
        ]
    )
    brown = np.array([rng.uniform(-0.12, 0.05), rng.uniform(-0.05, 0.08), *rng.normal(0, 3e-4, 2), 0.0])
    camera = SceneCamera(matrix, brown, size[::-1], np.zeros(3))
    views = calibration_views(8 if hold == "few" else 14, seed=seed, focal=(focal, matrix[1, 1]), size=size)
    if hold != "upright":
        views = [_quarter(v) if i % 3 == 1 else v for i, v in enumerate(views)]
    views = [replace(v, **SHAPES[shape]) for v in views]
    return Session(shape, hold, camera, views, 1.6 if hold == "soft" else 0.8)


def _quarter(view: BoardView) -> BoardView:
    """The same view with the board turned by a quarter, further off so that it stays in the picture."""
    turn = Rotation.from_rotvec(view.turn) * Rotation.from_rotvec([0, 0, np.pi / 2])
    farther = view.place[2] * (view.columns + 1) / (view.rows + 1)
    return replace(
        view, turn=tuple(turn.as_rotvec()), place=(0.4 * view.place[0], 0.3 * view.place[1], farther)
    )
