"""Sub-pixel edge points: each row (or column) that crosses the edge is fitted with a blurred step.

The hinge edge runs almost along the picture's columns and the bottom edge almost along its
rows, so pixels are taken as they are, without interpolation, and each row is one measurement.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import ceil

import numpy as np

from doormill_ros.arrays import BoolArray, ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.edge_points.texture import PHASES, phase_places, step_design
from doormill_ros.localization.view import HINGE, FaceView
from doormill_ros.statistics import median

WHITE = 253  # grey level from which a pixel counts as clipped
_ALONG = np.linspace(0.0, 1.0, 32)  # nodes along an edge; between them its picture is straight enough
_BEFORE = -5.0e-3  # m from the corner, before the first row that is read of an edge
_WEAKEST = 0.35  # share of the median step below which a row is not taken for edge


@dataclass(frozen=True, eq=False)
class Profiles:
    """Rows across one edge (columns for the bottom edge), and the edge point in each.

    Attributes:
        edge: "hinge" or "bottom".
        lines: Number of the row, shape (n,).
        centre: Column in the middle of `values`, shape (n,).
        values: Pixels of the rows about the edge, a column each, shape (2 half + 1, n), float32.
        place: Where the edge was predicted, from the middle of `values` [px], shape (n,).
        pixels: Edge points u, v [px], shape (n, 2).
        level: Grey level on the side of small u or v, shape (n,).
        contrast: Step towards growing u or v [grey levels], shape (n,).
        clipped: Rows that hold a clipped pixel, shape (n,), bool.
        edge_like: Rows with a step like that of the other rows, not clipped, shape (n,), bool.
    """

    edge: str
    lines: IntArray
    centre: IntArray
    values: Float32Array
    place: FloatArray
    pixels: FloatArray
    level: Float32Array
    contrast: Float32Array
    clipped: BoolArray
    edge_like: BoolArray

    @cached_property
    def step(self) -> float:
        """Median step inside minus outside [grey levels]; the door lies where u and v are small."""
        return -median(self.contrast[self.edge_like]) if self.edge_like.any() else 0.0


@lru_cache(maxsize=64)
def plain_weights(half: int, blur: float) -> Float32Array:
    """Least squares weights (PHASES, 3, w) of level, step and shift x step on untextured surfaces."""
    return np.linalg.pinv(step_design(phase_places(half), blur)).astype(np.float32)


def gather(picture: ByteArray, edge: str, lines: IntArray, centre: IntArray, span: IntArray) -> Float32Array:
    """Pixels at `centre + span` of each of `lines`, rows for the hinge edge, columns for the bottom edge.

    Args:
        picture: Grey picture, shape (h, w).
        edge: "hinge" or "bottom".
        lines: Numbers of the rows (columns), shape (n,).
        centre: Column (row) in the middle of each, shape (n,).
        span: Places about it, one after the other, shape (m,).

    Returns:
        Grey levels, a column for each line, shape (m, n); beyond the picture those at its rim.
    """
    height, width = picture.shape
    last, run, step = (width - 1, width, 1) if edge == HINGE else (height - 1, 1, width)
    flat = picture.ravel()
    if centre.size and centre.min() + span[0] >= 0 and centre.max() + span[-1] <= last:
        # Of all windows into the picture those about the edge are taken: no pixel's place need be worked out.
        windows = np.ndarray(
            (span.size, flat.size - (span.size - 1) * step), flat.dtype, flat, strides=(step, 1)
        )
        values = windows[:, lines * run + (centre + span[0]) * step]
    else:
        values = flat[np.clip(span[:, None] + centre, 0, last) * step + lines * run]
    return values.astype(np.float32, order="C")


def crossing(
    view: FaceView, edge: str, pose: FloatArray, half: int, start: float
) -> tuple[IntArray, FloatArray]:
    """Rows that cross the predicted edge and the columns where they do (bottom edge: the other way).

    Args:
        view: The camera before the face.
        edge: "hinge" or "bottom".
        pose: Predicted y, z [m] and rotation [rad], shape (3,).
        half: Pixels that must be in the picture on both sides.
        start: Distance from the corner at which to begin [m].

    Returns:
        Numbers of the rows, shape (n,), and where the edge crosses them [px], shape (n,).
    """
    nodes_run, nodes_cross = _nodes(view, edge, pose, start)
    width, height = view.camera.size
    limit_run, limit_cross = (height, width) if edge == HINGE else (width, height)
    first, last = max(ceil(nodes_run[0]), 0), min(int(nodes_run[-1]), limit_run - 1)
    lines = np.arange(first, last + 1)
    at = np.interp(lines, nodes_run, nodes_cross)
    usable = (at > half + 1) & (at < limit_cross - half - 2)
    return (lines, at) if usable.all() else (lines[usable], at[usable])


def crossed_at(view: FaceView, edge: str, pose: FloatArray, lines: IntArray) -> FloatArray:
    """Columns (rows for the bottom edge) where rows of these numbers (n,) cross an edge at `pose` (3,) [px], (n,)."""
    return np.interp(lines, *_nodes(view, edge, pose, _BEFORE))


def _nodes(view: FaceView, edge: str, pose: FloatArray, start: float) -> tuple[FloatArray, FloatArray]:
    """Numbers of rows, ascending, and columns where they cross an edge [px], from `start` [m] on, (32,) each."""
    along = start + _ALONG * (view.length(edge) + 0.025 - start)
    u, v = view.planes(view.line(edge, pose, along).T)[:, ::-1]
    return (v, u) if edge == HINGE else (u, v)


def measure(
    picture: ByteArray,
    view: FaceView,
    edge: str,
    pose: FloatArray,
    weights: Float32Array,
    every: int = 1,
    start: float = 0.8e-3,
) -> Profiles:
    """Edge points along the predicted edge.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        view: The camera before the face.
        edge: "hinge" or "bottom".
        pose: Predicted y, z [m] and rotation [rad], shape (3,).
        weights: Of level, step and shift x step for each sub-pixel phase, shape (PHASES, 3, 2 half + 1).
        every: Take only each n-th row.
        start: Distance from the corner at which to begin [m].
    """
    half = weights.shape[2] // 2
    lines, at = crossing(view, edge, pose, half, start)
    lines, at = lines[::every], at[::every]
    centre = np.rint(at).astype(np.intp)
    phase = np.minimum(((at - centre + 0.5) * PHASES).astype(np.intp), PHASES - 1)
    values = gather(picture, edge, lines, centre, np.arange(-half, half + 1))
    clipped = values.max(axis=0, initial=0) >= WHITE
    # All phases of all rows in one product cost less than picking each row's weights before it.
    every_phase = weights.reshape(-1, len(values)).dot(values)
    by_row = every_phase.reshape(PHASES, 3, -1).swapaxes(0, 1).reshape(3, -1)
    level, step, moment = by_row.take(phase * len(lines) + np.arange(len(lines)), axis=1)
    typical = median(step) if step.size else 0.0
    edge_like = (step if typical > 0 else -step) > max(_WEAKEST * abs(typical), 1e-3)
    edge_like &= ~clipped
    shift = np.divide(moment, step, out=np.zeros_like(moment), where=edge_like)
    edge_like &= np.abs(shift) < 0.6 * half
    place = (phase + 0.5) / PHASES - 0.5
    found = centre + place + np.minimum(np.maximum(shift, -half), half)
    pixels = np.empty((len(lines), 2))
    pixels[:, 0 if edge == HINGE else 1] = found
    pixels[:, 1 if edge == HINGE else 0] = lines
    return Profiles(edge, lines, centre, values, place, pixels, level, step, clipped, edge_like)
