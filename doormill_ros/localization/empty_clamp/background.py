"""Where the background of a picture lies against another picture of it, read in tiles that no door covers.

Both pictures are averaged down and divided by their brightness nearby, which light and its slow changes leave as it
is. One displacement with a turn and a growth is fitted to all tiles by Gauss and Newton (Lucas and Kanade 1981), each
weighted by what it leaves unexplained: dust, shadows and what came since count little. Noise is no structure: slopes of
the one picture are multiplied by those of the other, whose noise is another one.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import BoolArray, Float32Array, FloatArray
from doormill_ros.localization.empty_clamp.picture_pattern import (
    TILE,
    PicturePattern,
    PictureTiles,
    lasting,
    slopes_of,
)
from doormill_ros.localization.empty_clamp.quartered import DOWN

SURE = 0.25  #: largest standard deviation of a part of the displacement that is told [px]
_FLOOR = 2.0e-3  # of the pattern, left unexplained in the best tile
_TILES = 120  # tiles that are read at most: those with the most structure
_ROUNDS, _DONE, _STRIDE = 10, 0.05, 2.0  # steps of the fit, the last one and the largest one [averaged px]
_LEVER = 240.0  # averaged px at which turn and growth count as much as the shift
_FAINTEST = 4.0  # information below which a part of the displacement is left at zero [1 / averaged px ** 2]
_MORE = 20.0  # chi-square from which on turn and growth are there, beside the shift
_TIED = 3.0  # pixels that tell what one alone would
_APART = 30.0  # averaged px of a tile that tell something of their own
_STRUCTURE = 4.0  # standard deviations of chance from which on structure is judged
# Root mean square of a pattern that came: brightness nearby is none of the other picture's any more.
_NEW = 0.15
_PRESENT = 0.5  # share of a tile's structure that must be there


@dataclass(frozen=True, eq=False)
class PictureShift:
    """From a place in the one picture to that of the same thing in the other, up to a turn and a growth.

    Attributes:
        shift: Along u and v at `middle` [px], shape (2,).
        growth: As a share.
        turn: From u towards v [rad].
        middle: Of the pictures, u and v [px], shape (2,).
    """

    shift: FloatArray
    growth: float
    turn: float
    middle: FloatArray

    def at(self, pixels: FloatArray) -> FloatArray:
        """Displacement (..., 2) at pixels u, v (..., 2) [px]."""
        away = np.asarray(pixels, dtype=float) - self.middle
        across = np.stack([-away[..., 1], away[..., 0]], axis=-1)
        moved: FloatArray = self.shift + self.growth * away + self.turn * across
        return moved


@dataclass(frozen=True, eq=False)
class BackgroundFit:
    """How two pictures of a background lie upon each other.

    Attributes:
        displacement: From the one to the other; parts that the pictures leave open are zero.
        moved: Its root mean square over the tiles [px].
        deviation: Standard deviation of `moved` [px]; infinite where the pictures leave all of it open.
        tiles: Tiles that were read.
        judged: Those whose structure is more than noise.
        lost: Share of their structure that the one picture lacks.
        light: Brightness of the one as a multiple of the other's, at 10, 50 and 90 % of the tiles, shape (3,).
    """

    displacement: PictureShift
    moved: float
    deviation: float
    tiles: int
    judged: int
    lost: float
    light: FloatArray


def fit_background(one: PicturePattern, other: PicturePattern, free: BoolArray) -> BackgroundFit | None:
    """Lay one picture of a background upon another.

    Args:
        one: The pattern of the one.
        other: That of the other, of the same shape.
        free: Tiles that show the background in both, shape (rows, columns).

    Returns:
        The displacement from the one to the other and what they have in common; None where no tile is free.
    """
    tiles = _choose(other.structure, free)
    if not tiles.at.size:
        return None
    middle = 0.5 * np.array(one.relative.shape[::-1], dtype=float)
    away = (tiles.centres - middle) / _LEVER
    zero, unit = np.zeros(len(away)), np.ones(len(away))
    jacobian = np.stack(
        [
            np.column_stack([unit, zero, away[:, 0], -away[:, 1]]),
            np.column_stack([zero, unit, away[:, 1], away[:, 0]]),
        ],
        axis=1,
    )
    parameters = np.zeros(4)
    read = np.empty((len(tiles.at), 6, TILE * TILE), dtype=np.float32)
    tiles.read(one, read[:, :3])
    clean = _clean(one, other, free)[tiles.at[:, 0], tiles.at[:, 1]].astype(float)
    laid, parts = other, 2  # at first the shift alone
    for number in range(_ROUNDS):
        if number:
            laid = _laid(other.relative, parameters, middle)
        tiles.read(laid, read[:, 3:])
        products = _products(read)
        step = _step(products, jacobian[:, :, :parts], clean)
        if parts == 2 and step.size < _DONE:
            whole = _step(products, jacobian, clean)
            if whole.tells_more:
                step, parts = whole, 4
        parameters[:parts] += step.parts
        if step.size < _DONE:
            break
    known = step.known
    told = (step.axes.T @ parameters[:parts])[known]
    parameters[:parts] = step.axes[:, known] @ told
    if not known.all():  # what is left open has gone anywhere
        laid = _laid(other.relative, parameters, middle) if known.any() else other
        tiles.read(laid, read[:, 3:])
        products = _products(read)
    displaced = jacobian @ parameters
    part = jacobian[:, :, :parts] @ step.axes[:, known]
    spread = np.einsum("tia,ab,tib->t", part, step.covariance[np.ix_(known, known)], part).mean()
    lost, judged = _lost(products, read[:, 3])
    ratios = (tiles.of(one.grey).mean(axis=1) + 1.0) / (tiles.of(other.grey).mean(axis=1) + 1.0)
    return BackgroundFit(
        displacement=PictureShift(
            shift=DOWN * parameters[:2],
            growth=float(parameters[2] / _LEVER),
            turn=float(parameters[3] / _LEVER),
            middle=DOWN * middle + 0.5 * (DOWN - 1),
        ),
        moved=float(DOWN * np.sqrt(np.mean(np.sum(displaced**2, axis=1)))),
        deviation=float(DOWN * np.sqrt(spread)) if known.any() else np.inf,
        tiles=len(tiles.at),
        judged=judged,
        lost=lost,
        light=np.quantile(ratios, [0.1, 0.5, 0.9]).astype(float),
    )


def _choose(structure: FloatArray, free: BoolArray) -> PictureTiles:
    """The free tiles, or those of them with the most structure."""
    at = np.argwhere(free)
    if len(at) > _TILES:
        at = at[np.sort(np.argpartition(-structure[free], _TILES)[:_TILES])]
    return PictureTiles(at)


def _clean(one: PicturePattern, other: PicturePattern, free: BoolArray) -> BoolArray:
    """Tiles (rows, columns) in and beside which the one picture has nothing large that the other lacks."""
    new = free & (one.power - other.power > _NEW**2)
    return np.asarray(cv2.dilate(new.astype(np.uint8), np.ones((3, 3), dtype=np.uint8)) == 0)


def _laid(relative: Float32Array, parameters: FloatArray, middle: FloatArray) -> PicturePattern:
    """A pattern as the other picture would show it, displaced by `parameters` (4,) of `fit_background`."""
    growth, turn = parameters[2:] / _LEVER
    linear = np.array([[1.0 + growth, -turn], [turn, 1.0 + growth]])
    offset = parameters[:2] + middle - linear @ middle
    laid = cv2.warpAffine(
        relative,
        np.column_stack([linear, offset]),
        relative.shape[::-1],
        flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )
    return PicturePattern(relative, laid, slopes_of(laid))


def _products(read: Float32Array) -> FloatArray:
    """Mean products of a tile's three values in both pictures (n, 6, TILE * TILE) with each other, shape (n, 6, 6)."""
    return (read @ read.swapaxes(1, 2)).astype(float) / TILE**2


@dataclass(frozen=True, eq=False)
class _Step:
    """A step of the fit.

    Attributes:
        parts: Shift along u and v, growth and turn at `_LEVER` [averaged px], shape (2,) or (4,).
        axes: Along which they are apart, as columns, shape (n, n).
        information: Along these [1 / averaged px ** 2], shape (n,).
        covariance: Along these [averaged px ** 2], shape (n, n).
    """

    parts: FloatArray
    axes: FloatArray
    information: FloatArray
    covariance: FloatArray

    @property
    def size(self) -> float:
        """Its largest part [averaged px]."""
        return float(np.abs(self.parts).max())

    @property
    def known(self) -> BoolArray:
        """Along which axes the pictures tell where they lie, shape (n,)."""
        sure = np.sqrt(np.diag(self.covariance)) * DOWN < SURE
        return np.asarray(sure & (self.information > _FAINTEST))

    @property
    def tells_more(self) -> bool:
        """Whether growth and turn are surely there."""
        if self.information.min() <= _FAINTEST:
            return False
        more, covariance = self.parts[2:], (self.axes @ self.covariance @ self.axes.T)[2:, 2:]
        return float(more @ np.linalg.solve(covariance, more)) > _MORE


def _step(products: FloatArray, jacobian: FloatArray, clean: FloatArray) -> _Step:
    """The next step; its covariance is what the tiles themselves scatter (Huber's sandwich), and what noise makes."""
    left = products[:, 0, 0] - 2.0 * products[:, 0, 3] + products[:, 3, 3]
    weight = clean * TILE**2 / (left + _FLOOR**2)
    slopes = products[:, 1:3, 4:6]
    slopes = 0.5 * (slopes + slopes.swapaxes(1, 2))
    pull = 0.5 * (products[:, 1:3, 0] - products[:, 1:3, 3] + products[:, 4:6, 0] - products[:, 4:6, 3])
    by_slopes = weight[:, None, None] * (slopes @ jacobian)
    weighted = weight[:, None] * pull
    along = jacobian.reshape(-1, jacobian.shape[2])
    normal = along.T @ by_slopes.reshape(along.shape)
    gradient = along.T @ weighted.ravel()
    information, axes = np.linalg.eigh(0.5 * (normal + normal.T))
    information = np.maximum(information, _FAINTEST)
    step = axes @ ((axes.T @ gradient) / information)
    step *= min(1.0, _STRIDE / max(float(np.abs(step).max()), 1e-12))
    scores = np.einsum("tia,ti->ta", jacobian, weighted - by_slopes @ step)
    scores = scores @ axes
    covariance = (scores.T @ scores) / np.outer(information, information) + np.diag(_TIED / information)
    return _Step(step, axes, information, covariance)


def _lost(products: FloatArray, theirs: Float32Array) -> tuple[float, int]:
    """Share of the other picture's structure that the one lacks, and of how many tiles that is."""
    structure, common = lasting(theirs), products[:, 0, 3]
    chance = np.sqrt(products[:, 0, 0] * products[:, 3, 3] / _APART)
    judged = structure > _STRUCTURE * chance
    gone = judged & (common < _PRESENT * structure)
    size = np.sqrt(np.maximum(structure, 0.0))
    total = float(size[judged].sum())
    return (float(size[gone].sum()) / total if total else 0.0), int(np.count_nonzero(judged))
