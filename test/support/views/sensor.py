"""The window before the lens, the exposure and the sensor."""

from __future__ import annotations

import cv2
import numpy as np

from support.views.noise import smooth
from support.views.optics import Array
from support.views.view import Taking


def through_window(picture: Array, taking: Taking) -> Array:
    """The light of a picture behind a dirty window, a lens that vignettes and a shutter; shapes (height, width)."""
    height, width = picture.shape
    u = np.arange(width, dtype=np.float32)[None, :]
    v = np.arange(height, dtype=np.float32)[:, None]
    for blot in taking.blots:
        far = np.hypot(u - blot.u, v - blot.v)
        if blot.shift:
            # A drop is a weak lens: the picture below it is drawn towards its middle.
            inside = smooth((blot.radius - far) / blot.soft)
            pull = blot.shift * inside / np.maximum(far, 1.0)
            map_u = (u + (u - blot.u) * pull).astype(np.float32)
            map_v = (v + (v - blot.v) * pull).astype(np.float32)
            picture = cv2.remap(picture, map_u, map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        dimmed = smooth(0.5 + (blot.radius - far) / blot.soft)
        picture = picture * (1.0 - blot.dim * dimmed) + blot.veil * dimmed
    moved = float(np.hypot(*taking.motion))
    if moved > 0.0:
        kernel = np.zeros((9, 9), np.float32)
        for share in np.linspace(-0.5, 0.5, 41):
            x, y = 4.0 + share * taking.motion[0], 4.0 + share * taking.motion[1]
            i, j = int(x), int(y)
            for di, dj in ((0, 0), (1, 0), (0, 1), (1, 1)):
                kernel[j + dj, i + di] += abs(1 - di - (x - i)) * abs(1 - dj - (y - j))
        picture = cv2.filter2D(picture, -1, kernel / kernel.sum(), borderType=cv2.BORDER_REPLICATE)
    if taking.flicker[0]:
        picture = picture * (1.0 + taking.flicker[0] * np.sin(2.0 * np.pi * v / taking.flicker[1]))
    share, way = taking.uneven
    if share:
        across = ((u - width / 2) * np.cos(way) + (v - height / 2) * np.sin(way)) / (width / 2)
        picture = picture * (1.0 - share * (0.5 + 0.5 * across))
    r2 = ((u - width / 2) ** 2 + (v - height / 2) ** 2) / (width**2 + height**2) * 4.0
    found: Array = (picture * (1.0 - taking.vignetting * r2)).astype(np.float32)
    return found


def expose(ideal: Array, taking: Taking, rng: np.random.Generator) -> Array:
    """What the sensor gives for light in shares of full scale: uint8, same shape."""
    light = np.clip(ideal, 0.0, 1.5)
    deviation = np.sqrt(light / taking.photons + (taking.read / 255.0) ** 2)
    noisy = light + deviation * rng.standard_normal(light.shape, dtype=np.float32)
    found: Array = np.clip(np.rint(noisy * 255.0), 0, 255).astype(np.uint8)
    return found
