"""Finds the two edges to about a pixel on a reduced picture."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from doormill_ros.localization.view import HINGE, FaceView

REDUCE = 4  # the picture is averaged down by this factor for the search
_SEGMENT = 6.0e-3  # length of edge over which one step response is averaged [m]
_STEP = 3  # samples averaged on each side of a step


@dataclass(frozen=True, eq=False)
class Band:
    """Where one edge may lie, as sampling coordinates in the reduced picture.

    Attributes:
        across: Distance from the nominal edge, inside positive [m], shape (a,).
        along: Distance from the nominal corner [m], shape (n,).
        map_u: Column in the reduced picture, float32, shape (n, a).
        map_v: Row in the reduced picture, float32, shape (n, a).
    """

    across: np.ndarray
    along: np.ndarray
    map_u: np.ndarray
    map_v: np.ndarray


@lru_cache(maxsize=64)
def band(view: FaceView, edge: str, outside: float, inside: float, start: float) -> Band:
    """Sampling grid of one edge; cached, for it depends on the door's size only.

    Args:
        view: The camera before the face.
        edge: "hinge" or "bottom".
        outside: How far it reaches out of the nominal door [m].
        inside: How far it reaches into the nominal door [m].
        start: Where it starts along the edge [m].
    """
    step = REDUCE * view.pixel
    across = np.arange(-outside, inside, step)
    along = np.arange(start, view.length(edge), step)
    grid_along, grid_across = np.meshgrid(along, across, indexing="ij")
    pair = [grid_across, grid_along] if edge == HINGE else [grid_along, grid_across]
    at = (view.pixels(np.stack(pair, axis=-1)) + 0.5) / REDUCE - 0.5
    maps = (np.ascontiguousarray(at[..., i], dtype=np.float32) for i in range(2))
    return Band(across, along, *maps)


def reduced(picture: np.ndarray) -> np.ndarray:
    """The picture averaged over REDUCE x REDUCE pixels, in two halvings, which the library does fast."""
    height, width = picture.shape
    half = cv2.resize(picture, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
    return cv2.resize(half, (width // 4, height // 4), interpolation=cv2.INTER_AREA)


def step_scores(small: np.ndarray, where: Band, tilts: np.ndarray) -> np.ndarray:
    """Median step over segments along the edge, for each tilt and each place; grey levels, (k, a).

    The median lets chips, dust and a clamp cover up to half of the edge. Steps are inside minus outside.
    """
    values = cv2.remap(small, where.map_u, where.map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    spacing = where.along[1] - where.along[0]
    rows = max(int(round(_SEGMENT / spacing)), 1)
    segments = len(where.along) // rows
    means = values[: segments * rows].reshape(segments, rows, -1).mean(axis=1, dtype=np.float32)
    sums = np.cumsum(np.pad(means, ((0, 0), (1, 0))), axis=1)
    count = len(where.across)
    steps = np.zeros((segments, count), dtype=np.float32)
    middle = sums[:, _STEP : count + 1 - _STEP]
    steps[:, _STEP : count + 1 - _STEP] = (
        sums[:, 2 * _STEP :] + sums[:, : count + 1 - 2 * _STEP] - 2 * middle
    ) / _STEP
    centres = where.along[: segments * rows].reshape(segments, rows).mean(axis=1)
    shift = np.rint(np.outer(tilts, centres) / spacing).astype(int)  # (k, segments)
    at = np.clip(np.arange(count) + shift[..., None], 0, count - 1)
    return np.median(steps[np.arange(segments)[:, None], at], axis=1)


def search(picture: np.ndarray, view: FaceView, reach: float, rotation: float) -> np.ndarray:
    """Rough pose (y, z, rotation) of the door's corner.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        reach: Largest offset looked for [m].
        rotation: Largest rotation looked for [rad].
    """
    small = reduced(picture)
    edge_bands = [band(view, edge, reach, reach + 0.012, reach) for edge in ("hinge", "bottom")]
    spacing = REDUCE * view.pixel / max(b.along[-1] for b in edge_bands)
    tilts = np.arange(-np.ceil(rotation / spacing), np.ceil(rotation / spacing) + 1) * spacing
    # A door that turns by r moves its hinge edge by -r z in y and its bottom edge by +r y in z.
    scores = [
        np.abs(step_scores(small, b, sign * tilts)) for b, sign in zip(edge_bands, (-1, 1), strict=True)
    ]
    best = int(np.argmax(scores[0].max(axis=1) + scores[1].max(axis=1)))
    across = [b.across[int(np.argmax(s[best]))] for b, s in zip(edge_bands, scores, strict=True)]
    r = tilts[best]
    # The lines y = a - r z and z = b + r y meet in the corner.
    y, z = (across[0] - r * across[1]) / (1 + r * r), (across[1] + r * across[0]) / (1 + r * r)
    return np.array([y, z, np.arctan(r)])
