"""How soft an edge is, and whether it is one edge: all rows of an edge laid over each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtr

from doormill_ros.arrays import BoolArray, Float32Array, FloatArray, IntArray
from doormill_ros.localization.profiles import Profiles
from doormill_ros.localization.texture import PIXEL_VARIANCE, Variograms, covariance_function, step_design

_FINE = 2  # bins a pixel
_BLURS = np.geomspace(0.45, 9.0, 18)  # px
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
        some = np.flatnonzero(~np.isnan(self.at))
        wide = np.sqrt(self.blur**2 + PIXEL_VARIANCE)
        ends = self.mean.size // 8
        height = self.mean[-ends:].mean() - self.mean[:ends].mean()
        rest = self.mean[some] - height * ndtr(self.at[some] / wide)
        profile: FloatArray = np.interp(middle, middle[some], rest) + height * ndtr(middle / wide)
        return profile


def bin_places(size: int) -> FloatArray:
    """Distances of the bins of a mean profile of `size` bins from the edge, outwards [px], shape (size,)."""
    places: FloatArray = (np.arange(size) - (size - 1) / 2) / _FINE
    return places


@lru_cache(maxsize=16)
def _templates(half: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Blurred steps (b, m, 3), projectors (b, m, m) onto what they leave unexplained; bin centres (m,)."""
    place = np.arange(-half + 0.5, half - 0.5 + 1e-9, 1 / _FINE)
    design = np.stack([step_design(place, blur) for blur in _BLURS])
    return design, np.eye(place.size) - design @ np.linalg.pinv(design), place


def _lay_over(
    shape: Float32Array, index: IntArray, at: FloatArray, size: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean, its standard error and mean `at` (size,) of `shape` in the bins `index`; index `size` is nowhere."""
    index = index.ravel()
    count = np.bincount(index, minlength=size + 1)[:size]
    total = np.bincount(index, weights=shape.ravel(), minlength=size + 1)[:size]
    square = np.bincount(index, weights=(shape * shape).ravel(), minlength=size + 1)[:size]
    many = np.maximum(count, 1)
    mean = total / many
    place = np.bincount(index, weights=at.ravel(), minlength=size + 1)[:size] / many
    if not count.all():
        filled = np.flatnonzero(count)
        mean = np.interp(np.arange(size), filled, mean[filled])
        place[count == 0] = np.nan
    return mean, np.sqrt(np.maximum(square / many - mean * mean, 0.0) / many), place


def edge_spread(profiles: Profiles, shift: FloatArray, near: BoolArray) -> Spread:
    """Blur and singleness of an edge.

    Args:
        profiles: Rows across the edge.
        shift: Distance of the fitted line from the middle of each row's pixels [px], shape (n,).
        near: Rows whose edge point lies near the line: chips would smear the step, shape (n,), bool.
    """
    _, projector, place = _templates(profiles.values.shape[1] // 2)
    good = profiles.edge_like
    shape, index, at = _shares(profiles, shift, good)
    mean, error, seen = _lay_over(shape, index, at, place.size)
    misfit = np.sqrt(np.min(_left_over(projector, mean)))
    level = float(np.sqrt(np.mean(error**2)))
    near = near[good]
    if 2 * np.count_nonzero(near) > near.size > np.count_nonzero(near):
        mean, error, seen = _lay_over(shape[near], index[near], at[near], place.size)
    return Spread(_lowest(_left_over(projector, mean)), float(misfit), level, mean, error, seen)


def _shares(
    profiles: Profiles, shift: FloatArray, good: BoolArray
) -> tuple[Float32Array, IntArray, FloatArray]:
    """Pixels of the good rows as shares of their steps, their bins, and how far from the edge they are [px]; (k, w)."""
    half = profiles.values.shape[1] // 2
    place = _templates(half)[2]
    shape = (profiles.values[good] - profiles.level[good, None]) / profiles.contrast[good, None]
    at = np.arange(-half, half + 1) - shift[good, None]
    index = np.rint((at - place[0]) * _FINE).astype(np.intp)
    index[(index < 0) | (index >= place.size)] = place.size
    return shape, index, at


def _left_over(projector: FloatArray, mean: FloatArray) -> FloatArray:
    """Mean square (b,) of what each blur leaves of a profile unexplained."""
    left = projector @ mean
    squares: FloatArray = np.einsum("bm,bm->b", left, left) / mean.size
    return squares


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
    out = ndtr(bin_places(spread.mean.size) / np.sqrt(spread.blur**2 + PIXEL_VARIANCE))
    lag = _lags(out.size)
    covariance = np.diag(spread.error**2 + model**2)
    for share, side in ((1.0 - out, inside), (out, outside)):
        if side.lasting.any():
            covariance += covariance_function(side.lasting, _FINE)[lag] * (np.outer(share, share) / step**2)
    return covariance


def _lowest(costs: FloatArray) -> float:
    """The blur with the lowest cost, between those tried [px]."""
    i = min(max(int(np.argmin(costs)), 1), len(_BLURS) - 2)
    a, b, c = (float(v) for v in costs[i - 1 : i + 2])
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
    products = columns.T @ np.linalg.solve(covariance, columns)
    count = len(_BLURS)
    part = np.stack(
        [np.zeros(count, dtype=np.intp), 1 + np.arange(count), 1 + count + np.arange(count)], axis=1
    )
    moment = products[part, -1]
    explained = np.linalg.solve(products[part[:, :, None], part[:, None, :]], moment[..., None])[..., 0]
    blur = _lowest(-np.einsum("bi,bi->b", moment, explained))
    # What seems softer than any blur tried is not one step at all: `spread.misfit` is to say so, not the blur.
    return blur if blur < 0.99 * _BLURS[-1] else spread.blur


@lru_cache(maxsize=4)
def _lags(size: int) -> IntArray:
    lag: IntArray = np.abs(np.arange(size)[:, None] - np.arange(size))
    return lag
