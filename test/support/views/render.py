"""From a view to its picture: rays to each thing, the lens, the sensor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import cv2
import numpy as np

from support.views.light import Light
from support.views.optics import SIDE, Array, Rays, optics, slopes, within
from support.views.sensor import expose, through_window
from support.views.view import View

_WHITE = 0.97  #: brightness that one pixel in 200 may pass, share of full scale
_COARSE = 8  #: step between the rays that look where a thing is [px]


class _Thing(Protocol):
    def look(self, rays: Rays, light: Light) -> tuple[Array, Array, Array]: ...


@dataclass(frozen=True, eq=False)
class Drawn:
    """A picture before the noise of the sensor, share of full scale, and what covers what in it.

    Attributes:
        ideal: Light on the sensor, shape (height, width).
        cover: Of the door and what sticks to it, sharp, shape (height, width).
        before: Cover of all that is nearer than the face, sharp, shape (height, width).
    """

    ideal: Array
    cover: Array
    before: Array


def _trace(
    thing: _Thing, view: View, grid: tuple[Array, Array], where: Array, fine: bool
) -> tuple[Array, Array]:
    """Radiance times cover, and cover, shapes (height, width), of one thing in the pixels of a mask."""
    rows, columns = np.nonzero(where)
    shape = where.shape
    radiance, cover = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    if not len(rows):
        return radiance, cover
    centre = view.place.centre
    mark = np.full(shape, -1.0, np.float32)
    light, hidden, number = thing.look(Rays(centre, grid[0][where], grid[1][where]), view.light)
    radiance[where], cover[where], mark[where] = light * hidden, hidden, number
    kernel = np.ones((3, 3), np.uint8)
    close = where if fine else where & (cv2.dilate(mark, kernel) != cv2.erode(mark, kernel))
    rows, columns = np.nonzero(close)
    if len(rows):
        a, b = within(grid, rows, columns)
        light, hidden, _ = thing.look(Rays(centre, a.ravel(), b.ravel()), view.light)
        radiance[close] = (light * hidden).reshape(-1, SIDE).mean(axis=1)
        cover[close] = hidden.reshape(-1, SIDE).mean(axis=1)
    return radiance, cover


def _about(thing: object, view: View, grid: tuple[Array, Array]) -> Array:
    """Pixels in which a thing may be seen, shape (height, width) of bool."""
    coarse = [slope[::_COARSE, ::_COARSE] for slope in grid]
    margin = 2.0 * _COARSE * view.place.pixel * 1.5
    found = thing.near(Rays(view.place.centre, coarse[0].ravel(), coarse[1].ravel()), margin)  # type: ignore[attr-defined]
    mask = found.reshape(coarse[0].shape).astype(np.uint8)
    mask = cv2.dilate(mask, np.ones((3, 3), np.uint8))
    whole = np.repeat(np.repeat(mask, _COARSE, axis=0), _COARSE, axis=1)
    cut: Array = whole[: grid[0].shape[0], : grid[0].shape[1]] > 0
    return cut


def _spread(view: View, x: float) -> float:
    """Standard deviation of the point spread of things at this depth behind the face [px]."""
    focus = view.place.distance + view.taking.focus
    disc = view.taking.aperture * optics().k[0, 0] * abs(1.0 / (view.place.distance + x) - 1.0 / focus)
    return float(np.hypot(view.taking.psf, disc / 4.0))


def _blurred(picture: Array, sigma: float) -> Array:
    found: Array = cv2.GaussianBlur(picture, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
    return found


@lru_cache(maxsize=2)
def draw(view: View) -> Drawn:
    """The picture of a view as the sensor would have it without noise."""
    grid = slopes(view.place)
    on_face = _about(view.face, view, grid)
    radiance, cover = _trace(view.face, view, grid, on_face, False)
    solid = cv2.erode((cover > 0.999).astype(np.uint8), np.ones((41, 41), np.uint8)) > 0
    picture, _ = _trace(view.backdrop, view, grid, ~solid, False)
    picture = _blurred(picture, _spread(view, view.backdrop.x))
    for thing in sorted(view.behind, key=lambda it: -it.front):
        light, hidden = _trace(thing, view, grid, _about(thing, view, grid) & ~solid, thing.fine)
        sigma = _spread(view, thing.front)
        picture = picture * (1.0 - _blurred(hidden, sigma)) + _blurred(light, sigma)
    sigma = _spread(view, 0.0)
    inner = cover[solid]
    gain = view.taking.level / float(np.median(radiance[solid] / inner))
    picture = picture * (1.0 - _blurred(cover, sigma)) + _blurred(radiance, sigma)
    before = np.zeros_like(picture)
    for thing in sorted(view.before, key=lambda it: -it.front):
        light, hidden = _trace(thing, view, grid, _about(thing, view, grid), thing.fine)
        sigma = _spread(view, thing.front)
        picture = picture * (1.0 - _blurred(hidden, sigma)) + _blurred(light, sigma)
        before = np.maximum(before, hidden)
    # Who sets the exposure sees to it that hardly anything is white.
    gain = min(gain, _WHITE / float(np.quantile(picture[::4, ::4], 0.995)))
    return Drawn(through_window(picture * gain, view.taking), cover, before)


def render(view: View) -> Array:
    """The picture of a view, uint8 shape (height, width)."""
    rng = np.random.default_rng((view.seed, view.number, 1))
    return expose(draw(view).ideal, view.taking, rng)
