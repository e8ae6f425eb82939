"""Sub-pixel edge points: each row (or column) that crosses the edge is fitted with a blurred step.

The hinge edge runs almost along the picture's columns and the bottom edge almost along its
rows, so pixels are taken as they are, without interpolation, and each row is one measurement.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtr

from doormill_ros.localization.view import HINGE, FaceView

_PHASES = 32  # sub-pixel phases for which the fit's matrices are kept


@dataclass(frozen=True, eq=False)
class Profiles:
    """Edge points of one edge.

    Attributes:
        pixels: u, v [px], shape (n, 2).
        contrast: Step in the direction of growing u or v [grey levels], shape (n,).
        misfit: RMS of what the step leaves unexplained [grey levels], shape (n,).
    """

    pixels: np.ndarray
    contrast: np.ndarray
    misfit: np.ndarray


@lru_cache(maxsize=128)
def _fit_table(half: int, blur: float) -> tuple[np.ndarray, np.ndarray]:
    """Design (p, w, 3) and its pseudo-inverse (p, 3, w) of level, step and shift for each phase."""
    place = np.arange(-half, half + 1)[None] - ((np.arange(_PHASES) + 0.5) / _PHASES - 0.5)[:, None]
    # The pixel's own width adds 1/12 px^2 to the variance of the point spread.
    sigma = np.sqrt(blur**2 + 1.0 / 12.0)
    slope = np.exp(-0.5 * (place / sigma) ** 2) / (np.sqrt(2 * np.pi) * sigma)
    design = np.stack([np.ones_like(place), ndtr(place / sigma), -slope], axis=-1)
    return design.astype(np.float32), np.linalg.pinv(design).astype(np.float32)


def windows(picture: np.ndarray, lines: np.ndarray, centre: np.ndarray, half: int, edge: str) -> np.ndarray:
    """Pixels around `centre` on each of `lines` (row numbers for the hinge edge), shape (n, 2 half + 1)."""
    span = np.arange(-half, half + 1)
    if edge == HINGE:
        return picture[lines[:, None], centre[:, None] + span]
    return picture[centre[:, None] + span, lines[:, None]]


def predicted(
    view: FaceView, edge: str, pose: np.ndarray, half: int, start: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rows that cross the predicted edge and the columns where they do (bottom edge: the other way)."""
    along = np.linspace(start, view.length(edge) * 1.15 + 0.015, 48)
    pixels = view.pixels(view.line(edge, pose, along))
    run, cross = (1, 0) if edge == HINGE else (0, 1)
    order = np.argsort(pixels[:, run])
    nodes_run, nodes_cross = pixels[order, run], pixels[order, cross]
    width, height = view.camera.size
    limit_run, limit_cross = (height, width) if edge == HINGE else (width, height)
    lines = np.arange(max(int(np.ceil(nodes_run[0])), 0), min(int(nodes_run[-1]), limit_run - 1) + 1)
    at = np.interp(lines, nodes_run, nodes_cross)
    usable = (at > half + 1) & (at < limit_cross - half - 2)
    return lines[usable], at[usable]


def measure(
    picture: np.ndarray,
    view: FaceView,
    edge: str,
    pose: np.ndarray,
    blur: float,
    half: int,
    start: float = 1e-3,
) -> Profiles:
    """Edge points along the predicted edge.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        edge: "hinge" or "bottom".
        pose: Predicted y, z [m] and rotation [rad], shape (3,), right to about a pixel.
        blur: Standard deviation of the point spread [px].
        half: Pixels looked at on each side.
        start: Distance from the corner at which to begin [m].
    """
    lines, at = predicted(view, edge, pose, half, start)
    centre = np.rint(at).astype(np.intp)
    phase = np.clip(((at - centre + 0.5) * _PHASES).astype(np.intp), 0, _PHASES - 1)
    design, inverse = _fit_table(half, round(float(blur), 2))
    values = windows(picture, lines, centre, half, edge).astype(np.float32)
    fit = np.einsum("nkw,nw->nk", inverse[phase], values)
    misfit = values - np.einsum("nwk,nk->nw", design[phase], fit)
    step = fit[:, 1]
    safe = np.where(np.abs(step) < 1e-3, 1e-3, step)
    shift = np.clip(fit[:, 2] / safe, -half, half)
    found = centre + (phase + 0.5) / _PHASES - 0.5 + shift
    pixels = np.column_stack([found, lines] if edge == HINGE else [lines, found])
    return Profiles(pixels, step, np.sqrt(np.mean(misfit**2, axis=1)))
