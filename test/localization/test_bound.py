"""On clean pictures the spread is near what any estimator could reach."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.layout import DoorOffset
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.settings import load_settings
from doormill_ros.simulation.picture import expected_picture
from doormill_ros.simulation.picture_scene import Edges, PictureScene, Sensor, Surface

WIDTH, THICKNESS, NOISE = 0.9, 0.05, 2.0


def cramer_rao_deviations(scene: PictureScene, squareness: float) -> np.ndarray:
    """Smallest standard deviations of y, z and rotation, shape (3,).

    Fisher information of the simulator's own expected picture by central differences; both
    brightnesses are unknown, the right angle is known to `squareness` [rad], the noise is white
    and rounding to grey levels adds 1/12 to its variance.
    """

    def moved(step: np.ndarray) -> np.ndarray:
        offset = scene.offset
        return expected_picture(
            replace(
                scene,
                offset=DoorOffset(offset.y + step[0], offset.z + step[1], offset.rotation + step[2]),
                edges=replace(scene.edges, squareness=scene.edges.squareness + step[3]),
                face=Surface(scene.face.brightness + step[4]),
                background=Surface(scene.background.brightness + step[5]),
            ),
            0,
        ).astype(float)

    sizes = np.array([2e-5, 2e-5, 2e-4, 2e-4, 0.01, 0.01])
    columns = []
    for i, size in enumerate(sizes):
        step = np.zeros(6)
        step[i] = size
        columns.append(((moved(step) - moved(-step)) / (2 * size)).ravel())
    jacobian = np.stack(columns, axis=1) * sizes  # scaled, for the inverse's sake
    information = jacobian.T @ jacobian / (NOISE**2 + 1.0 / 12.0)
    information[3, 3] += (sizes[3] / squareness) ** 2
    return (np.sqrt(np.diag(np.linalg.inv(information))) * sizes)[:3]


@pytest.mark.parametrize("blur", [0.9, 2.0])
def test_spread_is_within_half_more_than_the_cramer_rao_bound(blur, camera, layout):
    scene = PictureScene(
        WIDTH,
        THICKNESS,
        DoorOffset(0.0031, -0.0042, 0.013),
        edges=Edges(roughness=0.0),
        sensor=Sensor(blur=blur, read_noise=NOISE, gain=0.0),
    )
    bound = cramer_rao_deviations(scene, load_settings().squareness)
    expected = expected_picture(scene, 0)
    rng = np.random.default_rng(17)
    found = []
    for _ in range(80):
        noisy = expected + NOISE * rng.standard_normal(expected.shape, dtype=np.float32)
        offset = localize(
            np.clip(np.rint(noisy), 0, 255).astype(np.uint8), camera, layout, WIDTH, THICKNESS
        ).offset
        found.append([offset.y, offset.z, offset.rotation])
    spread = np.std(found, axis=0, ddof=1)
    assert np.all(spread < 1.5 * bound), spread / bound
    # An unbiased estimator cannot beat the bound: if this one seems to, the bound is miscalculated.
    assert np.all(spread > 0.8 * bound), spread / bound
    bias = np.mean(found, axis=0) - [scene.offset.y, scene.offset.z, scene.offset.rotation]
    assert np.all(np.abs(bias) < [2e-6, 2e-6, 2e-5]), bias
