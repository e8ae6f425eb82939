"""From scene to sensor: rays through a distorting lens, point spread, noise."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from scipy.interpolate import RectBivariateSpline

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray
from doormill_ros.simulation.picture.scene import SceneCamera, Sensor

_NODE = 24  # spacing of the exact ray nodes [px]; a bicubic spline is exact to 1e-9 between them
_RIM = 1  # pixels around the picture for which rays are kept too

Block = tuple[int, int, int, int]  # first row, last row (excluded), first column, last column (excluded)


def lens(ideal: FloatArray, brown: FloatArray) -> FloatArray:
    """Where Brown's lens (k1, k2, p1, p2, k3) puts ideal rays x/z, y/z; (n, 2) to (n, 2)."""
    k1, k2, p1, p2, k3 = brown
    s = np.sum(ideal * ideal, axis=1)
    gain = 1.0 + k1 * s + k2 * s**2 + k3 * s**3
    cross = ideal[:, 0] * ideal[:, 1]
    return np.column_stack(
        [
            ideal[:, 0] * gain + 2 * p1 * cross + p2 * (s + 2 * ideal[:, 0] ** 2),
            ideal[:, 1] * gain + 2 * p2 * cross + p1 * (s + 2 * ideal[:, 1] ** 2),
        ]
    )


def _unlens(seen: FloatArray, brown: FloatArray) -> FloatArray:
    """Invert `lens` by Newton's method with a numeric Jacobian; (n, 2) to (n, 2)."""
    ideal, h = seen.copy(), 1e-6
    for _ in range(12):
        columns = [
            (lens(ideal + step, brown) - lens(ideal - step, brown)) / (2 * h)
            for step in (np.array([h, 0.0]), np.array([0.0, h]))
        ]
        miss = lens(ideal, brown) - seen
        ideal = ideal - np.linalg.solve(np.stack(columns, axis=-1), miss[..., None])[..., 0]
    return ideal


@lru_cache(maxsize=2)
def _rays(
    matrix: tuple[float, ...], brown: tuple[float, ...], shape: tuple[int, int]
) -> tuple[Float32Array, Float32Array]:
    """Rays x/z and y/z of every pixel and of a rim around the picture, (rows + 2, columns + 2) each."""
    rows, columns = shape
    v = np.arange(-_NODE, rows + 2 * _NODE, _NODE, dtype=float)
    u = np.arange(-_NODE, columns + 2 * _NODE, _NODE, dtype=float)
    grid_v, grid_u = np.meshgrid(v, u, indexing="ij")
    pixels = np.column_stack([grid_u.ravel(), grid_v.ravel(), np.ones(grid_u.size)])
    seen = (pixels @ np.linalg.inv(np.reshape(matrix, (3, 3))).T)[:, :2]
    ideal = _unlens(seen, np.array(brown))
    every_v, every_u = np.arange(-_RIM, rows + _RIM), np.arange(-_RIM, columns + _RIM)

    def at_pixels(nodes: FloatArray) -> Float32Array:
        spline = RectBivariateSpline(v, u, nodes.reshape(grid_v.shape))
        return np.asarray(spline(every_v, every_u), dtype=np.float32)

    return at_pixels(ideal[:, 0]), at_pixels(ideal[:, 1])


def rays(camera: SceneCamera, block: Block, fine: int) -> tuple[Float32Array, Float32Array]:
    """Ideal rays x/z and y/z through the sub-pixels of a block of the picture.

    Pixel (u, v) covers u - 0.5 .. u + 0.5; with `fine` sub-pixels along each axis the arrays
    have shape (rows * fine, columns * fine).
    """
    row0, row1, column0, column1 = block

    def within(whole: Float32Array) -> Float32Array:
        part = whole[row0 : row1 + 2 * _RIM, column0 : column1 + 2 * _RIM]
        if fine > 1:  # between neighbouring pixels the lens is linear to 1e-6 px
            part = cv2.resize(part, None, fx=fine, fy=fine, interpolation=cv2.INTER_LINEAR)
        return part[_RIM * fine : -_RIM * fine, _RIM * fine : -_RIM * fine]

    ray_x, ray_y = map(within, _rays(tuple(camera.matrix.ravel()), tuple(camera.brown), camera.shape))
    if np.array_equal(camera.turn, np.eye(3)):
        return ray_x, ray_y
    # Rays of a camera that was turned, seen by one that was not.
    seen = np.stack([ray_x, ray_y, np.ones_like(ray_x)], axis=-1) @ _turn(camera).T.astype(np.float32)
    return seen[..., 0] / seen[..., 2], seen[..., 1] / seen[..., 2]


def _turn(camera: SceneCamera) -> FloatArray:
    """The camera's turn in the axes of a camera that was not turned: x right, y down, z ahead; shape (3, 3)."""
    R_base_camera = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    turn: FloatArray = R_base_camera.T @ camera.turn @ R_base_camera
    return turn


def project(camera: SceneCamera, distance: float, across: FloatArray, up: FloatArray) -> FloatArray:
    """Pixels u, v (n, 2) of points at `distance` [m] ahead, base y and z [m] from the camera."""
    ahead = np.column_stack([-across, -up, np.full(len(across), distance)]) @ _turn(camera)
    seen = lens(ahead[:, :2] / ahead[:, 2:], camera.brown)
    return seen @ camera.matrix[:2, :2].T + camera.matrix[:2, 2]


def spread(radiance: Float32Array, sensor: Sensor, fine: int) -> Float32Array:
    """Point spread of the lens: Gaussian, and a disc when out of focus; (rows * fine, columns * fine) both."""
    out = radiance
    radius = sensor.defocus * fine
    if radius > 0.5:
        reach = int(np.ceil(radius)) + 1
        grid = np.hypot(*np.mgrid[-reach : reach + 1, -reach : reach + 1])
        disc = np.clip(radius - grid + 0.5, 0.0, 1.0).astype(np.float32)
        out = cv2.filter2D(out, -1, disc / disc.sum(), borderType=cv2.BORDER_REPLICATE)
    if sensor.blur > 0:
        out = cv2.GaussianBlur(out, (0, 0), sensor.blur * fine, borderType=cv2.BORDER_REPLICATE)
    return out


def bin_down(radiance: Float32Array, fine: int) -> Float32Array:
    """Mean over the sub-pixels of each pixel, the light its area collects; shape (rows, columns)."""
    rows, columns = radiance.shape
    light: Float32Array = cv2.resize(radiance, (columns // fine, rows // fine), interpolation=cv2.INTER_AREA)
    return light


def expose(radiance: Float32Array, sensor: Sensor, rng: np.random.Generator) -> ByteArray:
    """Grey levels of radiance (rows, columns) with photon and read noise, clipped and rounded; same shape."""
    grey = radiance * np.float32(255.0)
    deviation = cv2.sqrt(cv2.max(grey, 0.0) * np.float32(sensor.gain) + np.float32(sensor.read_noise**2))
    grey += deviation * rng.standard_normal(grey.shape, dtype=np.float32)
    picture: ByteArray = cv2.convertScaleAbs(cv2.max(grey, 0.0))
    return picture
