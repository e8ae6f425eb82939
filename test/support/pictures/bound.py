"""How well any estimator could read the door's pose from a picture: the Cramer-Rao bound.

It follows from the simulated scene alone, by central differences of the picture that is expected of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.simulation.picture.scene import PictureScene
from support.pictures.expected import expected_picture

# Half widths of the differences: y, z [m], rotation, squareness [rad], brightness of face and background.
_STEPS = np.array([2e-5, 2e-5, 2e-4, 2e-4, 0.01, 0.01])
_ROUNDING = 1.0 / 12.0  # variance of rounding to grey levels


def picture_information(scene: PictureScene) -> np.ndarray:
    """Fisher information of a picture of a scene without random fields, shape (6, 6).

    The parameters are y, z [m], rotation [rad], squareness [rad] and the brightness of face and background
    (1 is full scale). Noise is Gaussian and independent from pixel to pixel; its variance is that of the sensor
    and of rounding. Photon noise grows with the light and so tells of it too: with mean m and variance s^2 of a
    pixel, I_ij = m_i m_j / s^2 + (s^2)_i (s^2)_j / (2 s^4), where an index is a derivative.
    """

    def moved(step: np.ndarray) -> np.ndarray:
        offset = scene.offset
        return expected_picture(
            replace(
                scene,
                offset=DoorOffset(offset.y + step[0], offset.z + step[1], offset.rotation + step[2]),
                edges=replace(scene.edges, squareness=scene.edges.squareness + step[3]),
                face=replace(scene.face, brightness=scene.face.brightness + step[4]),
                background=replace(scene.background, brightness=scene.background.brightness + step[5]),
            ),
            0,
        ).astype(float)

    gain = scene.sensor.gain
    variance = scene.sensor.read_noise**2 + gain * expected_picture(scene, 0).astype(float) + _ROUNDING
    weight = np.sqrt(1.0 / variance + 0.5 * (gain / variance) ** 2)
    columns = [
        (weight * (moved(step) - moved(-step))).ravel() / (2 * size)
        for size, step in zip(_STEPS, np.diag(_STEPS), strict=True)
    ]
    jacobian = np.stack(columns, axis=1)
    return jacobian.T @ jacobian


def cramer_rao_deviations(scene: PictureScene, squareness: float) -> np.ndarray:
    """Smallest standard deviations of y, z [m] and rotation [rad], shape (3,).

    Both brightnesses are unknown, too.

    Args:
        scene: What is seen; see `picture_information`.
        squareness: Standard deviation to which the door's right angle is known beforehand [rad].
    """
    information = picture_information(scene) * np.outer(_STEPS, _STEPS)  # scaled, for the inverse's sake
    information[3, 3] += (_STEPS[3] / squareness) ** 2
    return (np.sqrt(np.diag(np.linalg.inv(information))) * _STEPS)[:3]
