"""What two pictures of one background have in common whatever the light: patterns, and tiles of them that are read."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from doormill_ros.arrays import BoolArray, ByteArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.empty_clamp.quartered import DOWN, quartered

TILE = 15  #: side of a tile [averaged px]
CLEAR = 10  #: between a tile and a door, so that the door's brightness is in no mean [averaged px]
_COARSE = 17  # averaged px that are "nearby"
_FINE = 1.0  # averaged px, standard deviation over which noise is averaged
_GAUSSIAN = cv2.getGaussianKernel(9, _FINE, cv2.CV_32F)
_STEEPEST = 0.5  # of the pattern: what is far brighter or darker than what is nearby must not decide
_LAG = 2  # averaged px over which a structure lasts and noise does not


@dataclass(frozen=True, eq=False)
class PicturePattern:
    """What can be compared of a picture, averaged down by `DOWN`.

    Attributes:
        grey: Brightness [grey levels], shape (h, w).
        relative: Of what is nearby less one, shape (h, w).
        slopes: Its change along u and v per averaged pixel, shape (h, w) each.
    """

    grey: Float32Array
    relative: Float32Array
    slopes: tuple[Float32Array, Float32Array]

    @property
    def values(self) -> tuple[Float32Array, Float32Array, Float32Array]:
        """What is compared, shape (h, w) each."""
        return self.relative, *self.slopes

    @cached_property
    def power(self) -> Float32Array:
        """Of all tiles, the mean square, shape (rows, columns)."""
        rows, columns = (side // TILE for side in self.relative.shape)
        squares = np.square(self.relative[: rows * TILE, : columns * TILE])
        return np.asarray(
            cv2.resize(squares, (columns, rows), interpolation=cv2.INTER_AREA), dtype=np.float32
        )

    @cached_property
    def structure(self) -> FloatArray:
        """Of all tiles, the variance that is none of noise, shape (rows, columns)."""
        rows, columns = (side // TILE for side in self.relative.shape)
        every = PictureTiles(np.argwhere(np.ones((rows, columns), dtype=bool)))
        return lasting(every.of(self.relative)).reshape(rows, columns)

    def worked_out(self) -> PicturePattern:
        """This pattern, with what is kept of it worked out, so that a picture need not wait for it."""
        _ = self.power, self.structure
        return self


def pattern_of(picture: ByteArray) -> PicturePattern:
    """The pattern of a grey picture, shape (h, w), uint8."""
    small = quartered(picture)
    # Filters of bytes into floats cost half of those of floats.
    nearby = cv2.max(cv2.boxFilter(small, cv2.CV_32F, (_COARSE, _COARSE)), 1.0)
    relative: Float32Array = cv2.sepFilter2D(small, cv2.CV_32F, _GAUSSIAN, _GAUSSIAN)
    relative /= nearby
    relative -= np.float32(1.0)
    np.clip(relative, -_STEEPEST, _STEEPEST, out=relative)
    return PicturePattern(small.astype(np.float32), relative, slopes_of(relative))


def covered(outline: FloatArray, shape: tuple[int, int]) -> BoolArray:
    """Which tiles (rows, columns) of a pattern of that shape lie in or too near to a polygon of pixels u, v (n, 2)."""
    mask = np.zeros(shape, dtype=np.uint8)
    corners = [np.rint((np.clip(outline, -1e4, 1e4) - 0.5 * (DOWN - 1)) / DOWN).astype(np.int32)]
    cv2.fillPoly(mask, corners, 1)
    cv2.polylines(mask, corners, isClosed=True, color=1, thickness=2 * CLEAR + 1)
    rows, columns = (side // TILE for side in shape)
    tiles = mask[: rows * TILE, : columns * TILE].reshape(rows, TILE, columns, TILE)
    return np.asarray(tiles.max(axis=1).max(axis=2) > 0)


@dataclass(frozen=True, eq=False)
class PictureTiles:
    """Tiles that are read: rows and columns (n, 2)."""

    at: IntArray

    @property
    def centres(self) -> FloatArray:
        """Their middles u, v (n, 2) [averaged px]."""
        return TILE * (self.at[:, ::-1].astype(float) + 0.5) - 0.5

    def of(self, values: Float32Array) -> Float32Array:
        """What they hold of values (h, w), shape (n, TILE * TILE)."""
        rows, columns = (side // TILE for side in values.shape)
        grid = values[: rows * TILE, : columns * TILE].reshape(rows, TILE, columns, TILE)
        read: Float32Array = grid[self.at[:, 0], :, self.at[:, 1]].reshape(len(self.at), TILE * TILE)
        return read

    def read(self, pattern: PicturePattern, into: Float32Array) -> None:
        """Put what they hold of the values of a pattern into an array (n, 3, TILE * TILE)."""
        for number, values in enumerate(pattern.values):
            into[:, number] = self.of(values)


def lasting(values: Float32Array) -> FloatArray:
    """Mean product of values `_LAG` apart, of tiles (n, TILE * TILE), shape (n,): the variance without the noise's."""
    grid = values.reshape(-1, TILE, TILE)
    along = np.einsum("tij,tij->t", grid[:, :, _LAG:], grid[:, :, :-_LAG])
    down = np.einsum("tij,tij->t", grid[:, _LAG:], grid[:, :-_LAG])
    mean: FloatArray = (along + down).astype(float) / (2 * TILE * (TILE - _LAG))
    return mean


def slopes_of(relative: Float32Array) -> tuple[Float32Array, Float32Array]:
    """Changes of a pattern along u and v per averaged pixel, of its shape (h, w)."""
    kernel = np.array([[-0.5, 0.0, 0.5]], dtype=np.float32)
    return cv2.filter2D(relative, -1, kernel), cv2.filter2D(relative, -1, kernel.T)
