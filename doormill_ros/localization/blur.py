"""How soft an edge is, and whether it is one edge: all rows of an edge laid over each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtr

from doormill_ros.localization.profiles import Profiles

_BIN = 0.5  # px
_BLURS = np.geomspace(0.45, 9.0, 40)  # px


@dataclass(frozen=True)
class Spread:
    """Blur of an edge.

    Attributes:
        blur: Standard deviation of the point spread [px].
        misfit: RMS difference of the mean profile from one blurred step, as a share of the step.
        level: Standard error of `misfit` expected from the rows' scatter.
    """

    blur: float
    misfit: float
    level: float


@lru_cache(maxsize=16)
def _templates(half: int) -> tuple[np.ndarray, np.ndarray]:
    """Projectors (b, m, m) onto what a blurred step at the origin leaves unexplained; bin centres (m,)."""
    place = np.arange(-half + 0.5, half - 0.5 + 1e-9, _BIN)
    sigma = np.sqrt(_BLURS**2 + 1.0 / 12.0)[:, None]
    slope = np.exp(-0.5 * (place / sigma) ** 2) / (np.sqrt(2 * np.pi) * sigma)
    design = np.stack([np.broadcast_to(1.0, slope.shape), ndtr(place / sigma), slope], axis=-1)
    projector = np.eye(place.size) - design @ np.linalg.pinv(design)
    return projector, place


def edge_spread(profiles: Profiles, shift: np.ndarray, good: np.ndarray) -> Spread:
    """Blur and singleness of an edge.

    Args:
        profiles: Rows across the edge.
        shift: Distance of the fitted line from the middle of each row's pixels [px], shape (n,).
        good: Rows to use, shape (n,), bool.
    """
    half = profiles.values.shape[1] // 2
    projector, place = _templates(half)
    step = profiles.contrast[good, None]
    shape = (profiles.values[good] - profiles.level[good, None]) / step
    at = np.arange(-half, half + 1) - shift[good, None]
    index = np.rint((at - place[0]) / _BIN).astype(int)
    inside = (index >= 0) & (index < place.size)
    count = np.bincount(index[inside], minlength=place.size)
    total = np.bincount(index[inside], weights=shape[inside], minlength=place.size)
    square = np.bincount(index[inside], weights=shape[inside] ** 2, minlength=place.size)
    many = np.maximum(count, 1)
    mean = total / many
    if np.any(count == 0):
        mean = np.interp(place, place[count > 0], mean[count > 0])
    error = np.sqrt(np.maximum(square / many - mean**2, 0) / many)
    left = np.einsum("bij,j->bi", projector, mean)
    costs = np.mean(left**2, axis=1)
    i = int(np.clip(np.argmin(costs), 1, len(_BLURS) - 2))
    a, b, c = costs[i - 1 : i + 2]
    bend = a - 2 * b + c
    move = np.clip(0.5 * (a - c) / bend, -1, 1) if bend > 0 else 0.0
    blur = float(_BLURS[i] * (_BLURS[1] / _BLURS[0]) ** move)
    return Spread(blur, float(np.sqrt(costs[i])), float(np.sqrt(np.mean(error**2))))
