"""From scene to sensor: rays through a distorting lens, point spread, noise."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from scipy.interpolate import RectBivariateSpline

from doormill_ros.simulation.picture_scene import SceneCamera, Sensor

_NODE = 24  # spacing of the exact ray nodes [px]; a bicubic spline is exact to 1e-9 between them


def _ideal_from_seen(seen: np.ndarray, brown: np.ndarray) -> np.ndarray:
    """Invert Brown's lens model by Newton's method with a numeric Jacobian; (n, 2) to (n, 2)."""
    k1, k2, p1, p2, k3 = brown

    def lens(q: np.ndarray) -> np.ndarray:
        s = np.sum(q * q, axis=1)
        gain = 1.0 + k1 * s + k2 * s**2 + k3 * s**3
        cross = q[:, 0] * q[:, 1]
        return np.column_stack(
            [
                q[:, 0] * gain + 2 * p1 * cross + p2 * (s + 2 * q[:, 0] ** 2),
                q[:, 1] * gain + 2 * p2 * cross + p1 * (s + 2 * q[:, 1] ** 2),
            ]
        )

    q, h = seen.copy(), 1e-6
    for _ in range(12):
        miss = lens(q) - seen
        columns = [
            (lens(q + step) - lens(q - step)) / (2 * h) for step in (np.array([h, 0.0]), np.array([0.0, h]))
        ]
        jacobian = np.stack(columns, axis=-1)
        q = q - np.linalg.solve(jacobian, miss[..., None])[..., 0]
    return q


@lru_cache(maxsize=4)
def _ray_spline(key: tuple) -> tuple[RectBivariateSpline, RectBivariateSpline]:
    matrix, brown, (rows, columns) = np.array(key[0]).reshape(3, 3), np.array(key[1]), key[2]
    v = np.arange(-_NODE, rows + 2 * _NODE, _NODE, dtype=float)
    u = np.arange(-_NODE, columns + 2 * _NODE, _NODE, dtype=float)
    grid_v, grid_u = np.meshgrid(v, u, indexing="ij")
    pixels = np.column_stack([grid_u.ravel(), grid_v.ravel(), np.ones(grid_u.size)])
    seen = (pixels @ np.linalg.inv(matrix).T)[:, :2]
    ideal = _ideal_from_seen(seen, brown)
    return tuple(RectBivariateSpline(v, u, ideal[:, i].reshape(grid_v.shape)) for i in range(2))


@lru_cache(maxsize=2)
def _full_rays(key: tuple) -> tuple[np.ndarray, np.ndarray]:
    rows, columns = key[2]
    splines = _ray_spline(key)
    return tuple(s(np.arange(rows), np.arange(columns)).astype(np.float32) for s in splines)


def rays(camera: SceneCamera, block: tuple[int, int, int, int], fine: int) -> tuple[np.ndarray, np.ndarray]:
    """Ideal rays x/z and y/z through the sub-pixels of a block of the picture.

    Args:
        camera: The true camera.
        block: First row, last row (excluded), first column, last column (excluded).
        fine: Sub-pixels per pixel along each axis.

    Returns:
        Two float32 arrays of shape (rows * fine, columns * fine).
    """
    key = (tuple(camera.matrix.ravel()), tuple(camera.brown), camera.shape)
    row0, row1, column0, column1 = block
    if fine == 1:
        return tuple(part[row0:row1, column0:column1] for part in _full_rays(key))
    # Pixel (u, v) covers u - 0.5 .. u + 0.5, so sub-pixel centres lie around the integer.
    v = row0 - 0.5 + (np.arange((row1 - row0) * fine) + 0.5) / fine
    u = column0 - 0.5 + (np.arange((column1 - column0) * fine) + 0.5) / fine
    return tuple(s(v, u).astype(np.float32) for s in _ray_spline(key))


def spread(radiance: np.ndarray, sensor: Sensor, fine: int) -> np.ndarray:
    """Point spread of the lens: Gaussian, and a disc when out of focus; same shape."""
    out = radiance
    if sensor.blur > 0:
        out = cv2.GaussianBlur(out, (0, 0), sensor.blur * fine, borderType=cv2.BORDER_REPLICATE)
    radius = sensor.defocus * fine
    if radius > 0.5:
        reach = int(np.ceil(radius)) + 1
        grid = np.hypot(*np.mgrid[-reach : reach + 1, -reach : reach + 1])
        disc = np.clip(radius - grid + 0.5, 0.0, 1.0).astype(np.float32)
        out = cv2.filter2D(out, -1, disc / disc.sum(), borderType=cv2.BORDER_REPLICATE)
    return out


def bin_down(radiance: np.ndarray, fine: int) -> np.ndarray:
    """Mean over the sub-pixels of each pixel: the light a pixel's area collects."""
    if fine == 1:
        return radiance
    rows, columns = radiance.shape
    return cv2.resize(radiance, (columns // fine, rows // fine), interpolation=cv2.INTER_AREA)


def expose(radiance: np.ndarray, sensor: Sensor, rng: np.random.Generator) -> np.ndarray:
    """Grey levels with photon and read noise, clipped and rounded; uint8, same shape."""
    grey = radiance * np.float32(255.0)
    deviation = np.sqrt(np.float32(sensor.read_noise**2) + np.float32(sensor.gain) * np.maximum(grey, 0))
    grey = grey + deviation * rng.standard_normal(grey.shape, dtype=np.float32)
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)
