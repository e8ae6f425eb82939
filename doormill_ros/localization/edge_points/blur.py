"""How soft an edge is, and whether it is one edge: all rows of an edge laid over each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import sqrt

import numpy as np
from scipy.linalg.lapack import dposv
from scipy.special import ndtr

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.localization.edge_points.profiles import Profiles
from doormill_ros.localization.edge_points.texture import (
    PIXEL_VARIANCE,
    Variograms,
    covariance_function,
    step_design,
)

_FINE = 2  # bins a pixel
_BLURS = np.geomspace(0.45, 9.0, 18)  # px
# Level, step and slope of each blur among the columns of all, shape (b, 3).
_PARTS = np.array([[0, 1 + i, 1 + len(_BLURS) + i] for i in range(len(_BLURS))])
_MODEL = 4.0e-3  # how far a true point spread is from a Gaussian one, as a share of the step


@dataclass(frozen=True, eq=False)
class Spread:
    """Blur of an edge.

    Attributes:
        blur: Standard deviation of the point spread [px].
        misfit: RMS difference of the mean profile from one blurred step, as a share of the step.
        level: Standard error of `misfit` expected from the rows' scatter.
        mean: Mean profile of the rows near their line, as a share of the step, shape (m,).
        error: Its standard error, shape (m,).
        at: Mean distance of the pixels of each of its bins from the edge [px], NaN where there are none, shape (m,).
    """

    blur: float
    misfit: float
    level: float
    mean: FloatArray
    error: FloatArray
    at: FloatArray

    def at_middles(self) -> FloatArray:
        """The mean profile at the middles of its bins (m,): rows of a door that stands straight share their phase.

        What the pixels are off is corrected by the one step nearest to the profile.
        """
        middle = bin_places(self.mean.size)
        some = ~np.isnan(self.at)
        wide = sqrt(self.blur**2 + PIXEL_VARIANCE)
        ends = self.mean.size // 8
        height = float(self.mean[-ends:].sum() - self.mean[:ends].sum()) / ends
        rest = self.mean[some] - height * ndtr(self.at[some] / wide)
        profile: FloatArray = np.interp(middle, middle[some], rest) + height * ndtr(middle / wide)
        return profile


@lru_cache(maxsize=16)
def bin_places(size: int) -> FloatArray:
    """Distances of the bins of a mean profile of `size` bins from the edge, outwards [px], shape (size,), read only."""
    places: FloatArray = (np.arange(size) - (size - 1) / 2) / _FINE
    places.setflags(write=False)
    return places


@lru_cache(maxsize=16)
def _templates(half: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Blurred steps (b, m, 3), orthonormal bases (b 3, m) of what each of them explains; bin centres (m,)."""
    place = np.arange(-half + 0.5, half - 0.5 + 1e-9, 1 / _FINE)
    design = np.stack([step_design(place, blur) for blur in _BLURS])
    bases = np.swapaxes(np.linalg.qr(design)[0], 1, 2).reshape(-1, place.size)
    return design, np.ascontiguousarray(bases), place


@dataclass(frozen=True, eq=False)
class _Sums:
    """Pixels of rows whose edge lies in the same half pixel, and where those fall in a mean profile.

    Attributes:
        bins: Bin of each pixel for each such half pixel, the profile's size where it is in none, shape (w r,).
        count: Rows, shape (g, r), for each of g choices of rows.
        total: Sum of their shares of the step, shape (g, w r).
        square: Sum of the squares, shape (g, w r).
        away: Sum of the pixels' distances from the edge [px], shape (g, w r).
    """

    bins: IntArray
    count: FloatArray
    total: FloatArray
    square: FloatArray
    away: FloatArray

    def laid_over(self, choice: int, size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mean, its standard error and mean distance from the edge [px] of chosen rows by bin, each (size,)."""
        rows = self.count[choice]
        per = np.empty((self.bins.size // rows.size, rows.size))
        per[:] = rows
        count, total, square, away = (
            np.bincount(self.bins, weights=of, minlength=size + 1)[:size]
            for of in (per.ravel(), self.total[choice], self.square[choice], self.away[choice])
        )
        many = np.maximum(count, 1.0)
        mean, place = total / many, away / many
        if not count.all():
            filled = count.nonzero()[0]
            mean = np.interp(np.arange(size), filled, mean[filled])
            place[count == 0] = np.nan
        return mean, np.sqrt(np.maximum(square / many - mean * mean, 0.0) / many), place


def _sums(profiles: Profiles, shift: FloatArray, choices: list[BoolArray], size: int) -> _Sums:
    """Sums over chosen rows; `shift` is that of `edge_spread`, each choice (n,), and the profile has `size` bins."""
    wide, good = len(profiles.values), profiles.edge_like
    shape = (profiles.values - profiles.level) / np.where(good, profiles.contrast, 1.0)
    both = np.empty((2 * wide, shape.shape[1]))
    both[:wide], both[wide:] = shape, shape * shape
    # A pixel further is _FINE bins further, so rows of one edge fall on few places only.
    first = np.rint((0.5 * (wide - 2) - shift) * _FINE).astype(np.intp)
    low, high = int(first.min()), int(first.max())
    rows = first == np.arange(low, high + 1)[:, None]
    many = len(rows)
    chosen = np.empty((len(choices) * many, rows.shape[1]))
    for number, choice in enumerate(choices):
        np.logical_and(rows, choice, out=chosen[number * many : (number + 1) * many], casting="unsafe")
    count, moved = chosen.sum(axis=1), chosen @ shift
    sums = (both @ chosen.T).reshape(2, wide, len(choices), many)
    pixel = np.arange(wide) - wide // 2
    away = pixel[:, None] * count - moved
    bins = _FINE * pixel[:, None] + np.arange(low, high + 1)
    bins[(bins < 0) | (bins >= size)] = size
    by_choice = sums.transpose(0, 2, 1, 3).reshape(2, len(choices), -1)
    return _Sums(
        bins.ravel(),
        count.reshape(len(choices), many),
        by_choice[0],
        by_choice[1],
        away.reshape(wide, len(choices), many).transpose(1, 0, 2).reshape(len(choices), -1),
    )


def edge_spread(profiles: Profiles, shift: FloatArray, near: BoolArray) -> Spread:
    """Blur and singleness of an edge.

    Args:
        profiles: Rows across the edge.
        shift: Distance of the fitted line from the middle of each row's pixels [px], shape (n,).
        near: Rows whose edge point lies near the line: chips would smear the step, shape (n,), bool.
    """
    _, bases, place = _templates(len(profiles.values) // 2)
    good = profiles.edge_like
    near = near & good
    many, close = int(np.count_nonzero(good)), int(np.count_nonzero(near))
    split = 2 * close > many > close
    sums = _sums(profiles, shift, [good, near] if split else [good], place.size)
    mean, error, seen = sums.laid_over(0, place.size)
    left = _left_over(bases, mean)
    misfit, level = sqrt(left.min()), sqrt(error @ error / error.size)
    if split:
        mean, error, seen = sums.laid_over(1, place.size)
        left = _left_over(bases, mean)
    return Spread(_lowest(left), misfit, level, mean, error, seen)


def _left_over(bases: FloatArray, mean: FloatArray) -> FloatArray:
    """Mean square (b,) of what each blur leaves of a profile (m,) unexplained, bases as in `_templates`."""
    explained = np.square(bases @ mean).reshape(-1, 3).sum(axis=1)
    left: FloatArray = np.maximum(mean @ mean - explained, 0.0) / mean.size
    return left


def profile_covariance(
    spread: Spread, step: float, inside: Variograms, outside: Variograms, model: float
) -> FloatArray:
    """Covariance of the errors of a mean profile, squared shares of the step, shape (m, m).

    Args:
        spread: The profile.
        step: Step at the edge [grey levels].
        inside: Texture of the face; its streaks last along the edge and remain in the mean.
        outside: Texture of what lies behind it.
        model: How far a true point spread is from a modelled one, as a share of the step.
    """
    out = ndtr(bin_places(spread.mean.size) / sqrt(spread.blur**2 + PIXEL_VARIANCE))
    lag = _lags(out.size)
    covariance = np.diag(spread.error**2 + model**2)
    for share, side in ((1.0 - out, inside), (out, outside)):
        if side.lasting.any():
            covariance += covariance_function(side.lasting, _FINE)[lag] * (share[:, None] * (share / step**2))
    return covariance


def _lowest(costs: FloatArray) -> float:
    """The blur with the lowest cost, between those tried [px]."""
    i = min(max(int(costs.argmin()), 1), len(_BLURS) - 2)
    a, b, c = costs[i - 1 : i + 2].tolist()
    bend = a - 2 * b + c
    move = min(max(0.5 * (a - c) / bend, -1.0), 1.0) if bend > 0 else 0.0
    return float(_BLURS[i] * (_BLURS[1] / _BLURS[0]) ** move)


def textured_blur(spread: Spread, step: float, inside: Variograms, outside: Variograms) -> float:
    """Blur of an edge [px] with streaks along it taken for what they are, by generalised least squares.

    Streaks lie over each other in all rows and remain in the mean profile, where they look
    like a softer edge.

    Args:
        spread: From `edge_spread`.
        step: Step at the edge [grey levels].
        inside: Texture of the face.
        outside: Texture of what lies behind it.
    """
    if max(inside.lasting.max(), outside.lasting.max()) < (_MODEL * step) ** 2:
        return spread.blur
    half = (spread.mean.size + 3) // (2 * _FINE)
    design, _, _ = _templates(half)
    covariance = profile_covariance(spread, step, inside, outside, _MODEL)
    columns = np.column_stack([design[0, :, 0], design[:, :, 1].T, design[:, :, 2].T, spread.mean])
    products = columns.T @ dposv(covariance, columns)[1]
    moment = products[_PARTS, -1]
    normal = products[_PARTS[:, :, None], _PARTS[:, None, :]]
    explained = np.linalg.solve(normal, moment[..., None])[..., 0]
    blur = _lowest(-np.einsum("bi,bi->b", moment, explained))
    # What seems softer than any blur tried is not one step at all: `spread.misfit` is to say so, not the blur.
    return blur if blur < 0.99 * _BLURS[-1] else spread.blur


@lru_cache(maxsize=4)
def _lags(size: int) -> IntArray:
    lag: IntArray = np.abs(np.arange(size)[:, None] - np.arange(size))
    return lag
