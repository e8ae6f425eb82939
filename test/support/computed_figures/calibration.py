"""What docs/calibration.md prints of the thesis' camera matrix and distortion (equation 3.43)."""

from __future__ import annotations

import itertools

import numpy as np

from doormill_ros.localization.calibration.lens_check import check_lens, distorted_radius
from doormill_ros.localization.camera import load_camera

#: As the thesis prints them, read as k1, k2, k3.
PRINTED = (0.0206, 10.4073, -115.4536)
_CAMERA = load_camera()
FX, FY, CX, CY = (float(_CAMERA.k[place]) for place in ((0, 0), (1, 1), (0, 2), (1, 2)))
_FOCAL = float(np.sqrt(FX * FY))

FOUND = check_lens(_CAMERA.k, _CAMERA.size, PRINTED)
CORNER, FOLD, REACH = FOUND.corner, FOUND.fold, FOUND.reach
CORNER_PIXELS, REACH_PIXELS = CORNER * _FOCAL, REACH * _FOCAL
BLIND, CORNER_SHIFT, USABLE = FOUND.blind_share, -FOUND.corner_shift, FOUND.usable
OTHERWISE_USABLE = max(
    check_lens(_CAMERA.k, _CAMERA.size, order).usable
    for order in itertools.permutations(PRINTED)
    if order != PRINTED
)
RATIO = FX / FY
MISMATCH = 1.0 - RATIO


def blind_the_other_way() -> float:
    """Share of the picture beyond the fold, the coefficients taken to lead from distorted to ideal."""
    height, width = _CAMERA.size[1], _CAMERA.size[0]
    v, u = np.mgrid[0:height:9, 0:width:9]
    return float(np.mean(np.hypot((u - CX) / FX, (v - CY) / FY) > FOLD))


def _in_the_middle() -> np.ndarray:
    r = np.linspace(0.01, 0.3, 100)
    return np.abs(np.asarray(distorted_radius(r, PRINTED)) - r) / np.stack([r, np.ones_like(r)])


def share_in_the_middle() -> float:
    """Largest share by which the lens moves a ray below r = 0.3."""
    return float(_in_the_middle()[0].max())


def pixels_in_the_middle() -> float:
    """The same way [px]."""
    return float(_in_the_middle()[1].max()) * _FOCAL
