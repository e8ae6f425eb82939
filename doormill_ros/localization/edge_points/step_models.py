"""One or two blurred steps, one spread by a disc or evenly, one over a rounded arris: profiles and derivatives."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from scipy.special import ndtr

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.edge_points.blur import bin_places
from doormill_ros.localization.edge_points.texture import PIXEL_VARIANCE

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(15)
_DISC = _WEIGHTS * np.sqrt(1 - _NODES**2)
DISC = _DISC / _DISC.sum()  #: a disc seen edge on
RAMP = _WEIGHTS / _WEIGHTS.sum()  #: what thins out evenly
_DISC_BLUR = 0.5  # px
_NORMAL = 1.0 / sqrt(2.0 * pi)


def blurred_step(place: FloatArray, blur: FloatArray | float) -> FloatArray:
    """A step of height 1 at distances `place` from it, both [px]; the pixel's own width is added to the blur."""
    sharp: FloatArray = ndtr(place / np.sqrt(np.square(blur) + PIXEL_VARIANCE))
    return sharp


class _Steps:
    """Level and one or two blurred steps at places that depend on parameters p, for one profile after another p.

    Attributes:
        count: Of level and heights, which are linear.
        columns: Level and steps at the last `at`, shape (count, m).
        jacobian: Derivatives by level, heights and places, shape (count + k, m); see `slopes`.
    """

    count = 2
    blur_at = 1

    def __init__(self, size: int, places: int) -> None:
        self._place = bin_places(size)
        self.jacobian: FloatArray = np.ones((self.count + places, size))
        self.columns: FloatArray = self.jacobian[: self.count]

    def _blurred(self, place: FloatArray, blur: float) -> FloatArray:
        """Steps of height 1 at distances `place` (..., m) of a `blur`, both [px], kept for their slopes."""
        self._sigma = sqrt(blur * blur + PIXEL_VARIANCE)
        self._scaled = place / self._sigma
        self._spread = blur / self._sigma
        steps: FloatArray = ndtr(self._scaled)
        return steps

    def _slopes(self) -> tuple[FloatArray, FloatArray]:
        """Derivatives of what `_blurred` gave last with respect to the steps' place and to the blur."""
        by_shift = self._scaled * self._scaled
        by_shift *= -0.5
        np.exp(by_shift, out=by_shift)
        by_shift *= -_NORMAL / self._sigma
        by_blur = by_shift * self._scaled
        by_blur *= self._spread
        return by_shift, by_blur


class OneStep(_Steps):
    """One step; p is its shift and its blur [px]."""

    def __init__(self, size: int) -> None:
        super().__init__(size, 2)

    def at(self, p: list[float]) -> FloatArray:
        """Level and steps for p, shape (count, m), which the next call overwrites."""
        self.columns[1] = self._blurred(self._place - p[0], p[1])
        return self.columns

    def slopes(self, heights: list[float]) -> FloatArray:
        """Derivatives of the profile at the last `at` by level, heights and places, shape (count + k, m)."""
        by_shift, by_blur = self._slopes()
        np.multiply(by_shift, heights[0], out=self.jacobian[2])
        np.multiply(by_blur, heights[0], out=self.jacobian[3])
        return self.jacobian


class TwoSteps(_Steps):
    """Two steps; p is the outer's shift, how far inside of it the inner is, and their blur [px]."""

    count = 3
    blur_at = 2

    def __init__(self, size: int) -> None:
        super().__init__(size, 3)
        self._both = np.empty((2, size))

    def at(self, p: list[float]) -> FloatArray:
        """Level and steps for p, shape (count, m), which the next call overwrites."""
        outer, inner = self._both
        np.subtract(self._place, p[0], out=outer)
        np.add(outer, p[1], out=inner)
        self.columns[1:] = self._blurred(self._both, p[2])
        return self.columns

    def slopes(self, heights: list[float]) -> FloatArray:
        """Derivatives of the profile at the last `at` by level, heights and places, shape (count + k, m)."""
        by_shift, by_blur = self._slopes()
        weights = np.array(heights)
        weights.dot(by_shift, self.jacobian[3])
        np.multiply(by_shift[1], -heights[1], out=self.jacobian[4])
        weights.dot(by_blur, self.jacobian[5])
        return self.jacobian


class SpreadStep(_Steps):
    """One step that is spread by `share` of each of _NODES; p is shift, reach and, where it is fitted, blur [px]."""

    blur_at = 2

    def __init__(self, size: int, share: FloatArray, places: int) -> None:
        super().__init__(size, places)
        self._share = share

    def at(self, p: list[float]) -> FloatArray:
        """Level and steps for p, shape (count, m), which the next call overwrites."""
        place = np.add.outer(-p[1] * _NODES, self._place - p[0])
        self.columns[1] = self._share @ self._blurred(place, p[2] if len(p) > 2 else _DISC_BLUR)
        return self.columns

    def slopes(self, heights: list[float]) -> FloatArray:
        """Derivatives of the profile at the last `at` by level, heights and places, shape (count + k, m)."""
        by_shift, by_blur = self._slopes()
        rows = self.jacobian[2:]
        rows[:2] = self._shares @ by_shift
        if len(rows) > 2:
            rows[2] = self._share @ by_blur
        rows *= heights[0]
        return self.jacobian

    @property
    def _shares(self) -> FloatArray:
        return np.array((self._share, self._share * _NODES))


class RoundedStep(_Steps):
    """A slope that falls evenly, and at its end what is left of the step; p is its end, its width and the blur [px]."""

    blur_at = 2

    def __init__(self, size: int, left: float) -> None:
        """Of `left`, what the end of the slope has of the whole step."""
        super().__init__(size, 3)
        self._left = left
        self._both = np.empty((2, size))

    def at(self, p: list[float]) -> FloatArray:
        """Level and step for p, shape (count, m), which the next call overwrites."""
        outer, inner = self._both
        np.subtract(self._place, p[0], out=outer)
        np.add(outer, p[1], out=inner)
        self._width = p[1]
        self._ends = self._blurred(self._both, p[2])
        self._bells = np.exp(-0.5 * self._scaled * self._scaled)
        self._bells *= _NORMAL
        # Steps that lie side by side are the difference of two integrals of one.
        integrals = self._sigma * (self._scaled * self._ends + self._bells)
        self._slope = (integrals[1] - integrals[0]) / p[1]
        self.columns[1] = self._left * self._ends[0] + (1.0 - self._left) * self._slope
        return self.columns

    def slopes(self, heights: list[float]) -> FloatArray:
        """Derivatives of the profile at the last `at` by level, heights and places, shape (count + k, m)."""
        ends, bells, scaled, sigma = self._ends, self._bells, self._scaled, self._sigma
        step, slope = self._left * heights[0], (1.0 - self._left) * heights[0] / self._width
        rows = self.jacobian[2:]
        rows[0] = (-step / sigma) * bells[0] - slope * (ends[1] - ends[0])
        rows[1] = slope * (ends[1] - self._slope)
        rows[2] = (-step / sigma) * scaled[0] * bells[0] + slope * (bells[1] - bells[0])
        rows[2] *= self._spread
        return self.jacobian
