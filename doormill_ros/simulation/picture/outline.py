"""The outline of the door's face: a rough, chipped line a table can hold."""

from __future__ import annotations

import cv2
import numpy as np

from doormill_ros.arrays import Float32Array, FloatArray
from doormill_ros.simulation.picture.scene import Chip, Edges

_STEP = 2.0e-5  # spacing of the table [m]
_IN_VIEW = 0.05  # middle of the part of an edge that the camera sees [m]
_START, _STOP = -0.02, 0.22  # range of the table along the edge [m]


def wander(rng: np.random.Generator, rms: float, correlation: float, count: int, step: float) -> FloatArray:
    """A stationary Gaussian process with autocorrelation exp(-(s/correlation)^2), shape (count,).

    Args:
        rng: Source of randomness.
        rms: Standard deviation [m].
        correlation: Distance over which the autocorrelation falls to 1/e [m].
        count: Number of values.
        step: Their spacing [m].
    """
    # White noise through a Gaussian of width correlation / 2 has that autocorrelation.
    coarse = correlation / 16.0
    nodes = int(np.ceil(count * step / coarse)) + 2
    reach = np.arange(-48, 49) / 16.0
    kernel = np.exp(-2.0 * reach**2)
    rough = np.convolve(rng.standard_normal(nodes + 96), kernel / np.sqrt(np.sum(kernel**2)), mode="valid")
    field: FloatArray = rms * np.interp(np.arange(count) * step, np.arange(nodes) * coarse, rough)
    return field


def _bite(chip: Chip, along: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Depth of one chip at places `along` the edge [m]: a broken arc with a ragged floor; both (n,) [m]."""
    place = (along - chip.along) / (chip.length / 2.0)
    arc = np.clip(1.0 - place**2, 0.0, None) ** 0.5
    ragged = 1.0 + 0.3 * wander(rng, 1.0, chip.length / 4.0, along.size, _STEP)
    return chip.depth * arc * np.clip(ragged, 0.2, 1.6)


class EdgeProfile:
    """How far one edge of the face lies inside its ideal line."""

    def __init__(self, rng: np.random.Generator, edges: Edges, name: str) -> None:
        """Draw the roughness and cut the chips of edge `name`, "hinge" or "bottom"."""
        count = round((_STOP - _START) / _STEP)
        along: FloatArray = _START + np.arange(count, dtype=float) * _STEP
        table = wander(rng, edges.roughness, edges.correlation, count, _STEP)
        for chip in edges.chips:
            if chip.edge == name:
                table = np.maximum(table, _bite(chip, along, rng) + table)
        bow = edges.bow[0] if name == "hinge" else edges.bow[1]
        table = table + bow * (1.0 - (2.0 * (along - _IN_VIEW) / edges.bow_length) ** 2)
        self._table = table.astype(np.float32)[None]

    @property
    def deepest(self) -> float:
        """Deepest place [m]."""
        return float(self._table.max())

    def __call__(self, along: Float32Array) -> Float32Array:
        """Depth [m] at distances `along` [m] from the corner, shape (n, m); same shape."""
        at = (along - np.float32(_START)) * np.float32(1.0 / _STEP)
        depth: Float32Array = cv2.remap(
            self._table, at, np.zeros_like(at), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        return depth
