"""The strip of the picture in which an edge may lie, straightened, and the steps found in it.

`across` is the distance from the nominal edge, inside positive; `along` the distance from the
nominal corner. The strip is sampled from the picture averaged down by ACROSS and ALONG.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.empty_clamp.quartered import quartered
from doormill_ros.localization.errors import NoEdge
from doormill_ros.localization.view import BOTTOM, HINGE, FaceView
from doormill_ros.statistics import row_medians, running_means

ACROSS, ALONG = 4, 8  # pixels averaged for the search, across the edge and along it
WING = 2  # samples averaged on each side of a step
_SEGMENT = 4.0e-3  # length of edge over which a step is averaged before the median [m]


@dataclass(frozen=True, eq=False)
class Band:
    """Where one edge may lie, as sampling coordinates in the reduced picture.

    Attributes:
        across: Distance from the nominal edge [m], shape (a,).
        along: Distance from the nominal corner [m], shape (n,).
        map_u: Column in the reduced picture, float32, shape (n, a).
        map_v: Row in the reduced picture, float32, shape (n, a).
    """

    across: FloatArray
    along: FloatArray
    map_u: Float32Array
    map_v: Float32Array

    @cached_property
    def step(self) -> float:
        """Spacing of the samples across the edge [m]."""
        return float(self.across[1] - self.across[0])

    @cached_property
    def pitch(self) -> float:
        """Spacing of the samples along the edge [m]."""
        return float(self.along[1] - self.along[0])


@lru_cache(maxsize=64)
def band(view: FaceView, edge: str, reach: float, inside: float) -> Band:
    """Sampling grid of one edge; cached, for it depends on the door's size only.

    Args:
        view: The camera before the face.
        edge: "hinge" or "bottom".
        reach: How far it reaches out of the nominal door and beyond its corner [m].
        inside: How far it reaches into the nominal door [m].
    """
    across = np.arange(-reach, inside, ACROSS * view.pixel)
    along = np.arange(-reach, view.length(edge), ALONG * view.pixel)
    # The lens is smooth: polynomials through a few nodes are right to a hundredth of a pixel.
    grid_along, grid_across = np.meshgrid(_stretch(along), _stretch(across), indexing="ij")
    pair = [grid_across, grid_along] if edge == HINGE else [grid_along, grid_across]
    factors = (ACROSS, ALONG) if edge == HINGE else (ALONG, ACROSS)
    at = (view.pixels(np.stack(pair, axis=-1)) + 0.5) / factors - 0.5
    left, right = _lagrange(along.size), _lagrange(across.size).T
    map_u, map_v = ((left @ at[..., i] @ right).astype(np.float32) for i in range(2))
    return Band(across, along, map_u, map_v)


_NODES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(7) + 0.5) / 7)  # Chebyshev's, between 0 and 1


def _stretch(samples: FloatArray) -> FloatArray:
    """The nodes between the first and the last sample."""
    nodes: FloatArray = samples[0] + _NODES * (samples[-1] - samples[0])
    return nodes


@lru_cache(maxsize=64)
def _lagrange(count: int) -> FloatArray:
    """Weights (count, 7) that carry values at the nodes to `count` even samples."""
    powers = np.vander(np.linspace(0.0, 1.0, count), _NODES.size)
    return powers @ np.linalg.inv(np.vander(_NODES))


def reduced(picture: ByteArray) -> dict[str, Float32Array]:
    """The picture averaged down for each edge.

    Args:
        picture: Grey picture, shape (h, w).

    Returns:
        By edge, shape (h / 8, w / 4) for the hinge and (h / 4, w / 8) for the bottom edge.
    """
    quarter = quartered(picture).astype(np.float32)
    rows, columns = len(quarter) // 2 * 2, quarter.shape[1] // 2 * 2
    return {
        HINGE: (quarter[0:rows:2] + quarter[1:rows:2]) * np.float32(0.5),
        BOTTOM: (quarter[:, 0:columns:2] + quarter[:, 1:columns:2]) * np.float32(0.5),
    }


@dataclass(frozen=True, eq=False)
class Steps:
    """Brightness steps in a band: mean inside minus mean outside [grey levels].

    Attributes:
        where: The band.
        rows: Step at each sample, shape (n, a).
        segments: Means of it over pieces of edge that are inside the door wherever it stands, shape (s, a).
        centres: Distance of the pieces from the nominal corner [m], shape (s,).
        middle: Distance of the pieces' middle from the nominal corner [m].
        tilts: Slopes of the lines tried, across per along, shape (k,).
        scores: Median over the pieces for each tilt; column j is a line that passes `across[j]` in
            the middle of the pieces, shape (k, c).
        texture: The same for a few tilts in columns c.. where no edge can be, shape (l, a - c).
        brightness: Median brightness just inside of each column [grey levels], shape (a,).
    """

    where: Band
    rows: Float32Array
    segments: Float32Array
    centres: FloatArray
    middle: float
    tilts: FloatArray
    scores: Float32Array
    texture: Float32Array
    brightness: Float32Array

    def along_line(
        self, across: float, tilt: float, start: float, stop: float, quantile: float = 0.5
    ) -> float:
        """Quantile of the steps on a line between two places along it; 0 where there are none [grey levels]."""
        rows, columns = self.under_line(across, tilt, start, stop)
        if rows.size == 0:
            return 0.0
        found = np.sort(self.rows[rows, np.minimum(np.maximum(columns, 0), len(self.where.across) - 1)])
        return float(found[int(quantile * (found.size - 1) + 0.5)])

    def under_line(self, across: float, tilt: float, start: float, stop: float) -> tuple[IntArray, IntArray]:
        """Rows and columns under a line between two places along it, shape (m,) each; columns may lie outside."""
        where = self.where
        first, last = np.searchsorted(where.along, [start, stop])
        rows = np.arange(first, last)
        at = np.rint((across + tilt * where.along[rows] - where.across[0]) / where.step).astype(int)
        return rows, at


def find_steps(small: Float32Array, where: Band, tilts: FloatArray, free: float, reach: float) -> Steps:
    """Steps of a reduced picture in a band.

    The median over pieces lets chips, dust, screws and clamps cover almost half of the edge.

    Args:
        small: Picture reduced for this edge.
        where: The band.
        tilts: Slopes to try, shape (k,).
        free: Distance from the nominal corner beyond which the edge exists wherever the door stands [m].
        reach: Largest distance of an edge's middle from its nominal place [m].
    """
    values = cv2.remap(small, where.map_u, where.map_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    count = len(where.across)
    wing = running_means(values, WING)
    rows = np.zeros((len(where.along), count), dtype=np.float32)
    np.subtract(wing[:, WING:], wing[:, :-WING], out=rows[:, WING : count + 1 - WING])
    first = int(np.searchsorted(where.along, free))
    per = max(round(_SEGMENT / where.pitch), 1)
    pieces = (len(where.along) - first) // per
    if pieces < 1:
        raise NoEdge(
            "too little of an edge of the door is in the picture; check the slider and the door's size in the recipe"
        )
    used = slice(first, first + pieces * per)
    segments = rows[used].reshape(pieces, per, count).sum(axis=1) * np.float32(1.0 / per)
    centres = where.along[used].reshape(pieces, per).mean(axis=1)
    middle = float(centres.mean())

    near = int(np.searchsorted(where.across, reach)) + WING + 1
    shift = np.rint(np.multiply.outer(tilts, centres - middle) / where.step).astype(np.intp)  # (k, pieces)
    rim = max(int(np.abs(shift).max()), 1)
    padded = np.empty((pieces, count + 2 * rim), dtype=segments.dtype)  # lines may leave the band
    padded[:, :rim], padded[:, rim:-rim], padded[:, -rim:] = segments[:, :1], segments, segments[:, -1:]

    def scores(first: int, last: int, every: slice) -> Float32Array:
        many, stride = last - first, padded.itemsize
        columns = np.ndarray((padded.size - many + 1, many), padded.dtype, padded, strides=(stride, stride))
        starts = shift[every] + (rim + first + padded.shape[1] * np.arange(pieces))
        return row_medians(columns[starts].transpose(0, 2, 1))

    inside = np.minimum(np.arange(count) + WING, count - 1)
    return Steps(
        where=where,
        rows=rows,
        segments=segments,
        centres=centres,
        middle=middle,
        tilts=tilts,
        scores=scores(0, near, slice(None)),
        texture=scores(near + WING, count - WING, slice(len(tilts) % 3 // 2, None, 3)),
        brightness=row_medians(values[first::per].T)[inside],
    )
