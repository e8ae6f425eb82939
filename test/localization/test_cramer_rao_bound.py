"""On clean pictures the spread is near what any estimator could reach."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.settings import load_settings
from doormill_ros.simulation.picture.scene import Edges, PictureScene, Sensor
from support.pictures.bound import cramer_rao_deviations, picture_information
from support.pictures.expected import expected_picture

WIDTH, THICKNESS, NOISE = 0.9, 0.05, 2.0


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


@pytest.mark.parametrize("gain", [0.0, 0.05])
def test_information_about_y_is_that_of_a_blurred_step_in_each_row(gain, camera, layout):
    """A row tells of its edge the integral of (slope of the light)^2 over the variance of the noise."""
    blur = 1.6
    scene = PictureScene(
        WIDTH, THICKNESS, DoorOffset(0.002, 0.001, 0.0), sensor=Sensor(blur=blur, read_noise=NOISE, gain=gain)
    )
    T_base_door = layout.T_base_door(WIDTH, THICKNESS, scene.offset)
    along = np.linspace(0.0, 0.15, 3000)[:, None]
    u, v = camera.project(T_base_door[:3, 3] + along * T_base_door[:3, 2], WIDTH).T
    beside = camera.project(T_base_door[:3, 3] + [0, 1e-4, 0] + along * T_base_door[:3, 2], WIDTH)[:, 0]
    rows = np.arange(0, v[0])
    per_metre = np.interp(rows, v[::-1], (beside - u)[::-1] / 1e-4)  # px a row's edge moves per metre of y
    # The pixel's own width adds 1/12 to the variance of the point spread.
    place, sigma = np.linspace(-12, 12, 4001), np.sqrt(blur**2 + 1.0 / 12.0)
    slope = np.exp(-0.5 * (place / sigma) ** 2) / np.sqrt(2 * np.pi * sigma**2)
    dark, bright = 255 * scene.background.brightness, 255 * scene.face.brightness
    level = dark + (bright - dark) * np.cumsum(slope) * (place[1] - place[0])
    variance = NOISE**2 + 1.0 / 12.0 + gain * level
    told = np.sum((slope * (bright - dark)) ** 2 * (1 / variance + 0.5 * (gain / variance) ** 2))
    told *= place[1] - place[0]
    assert picture_information(scene)[0, 0] == pytest.approx(np.sum(told * per_metre**2), rel=0.02)
