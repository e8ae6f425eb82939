"""Whether the edges of the door stand plainly in a view, by what was put into it."""

from __future__ import annotations

import cv2
import numpy as np

from support.views.optics import Array, optics, pixels_of
from support.views.render import draw
from support.views.view import View

STEP = 0.06  #: least step of brightness over an edge, share of full scale
ABOVE_TEXTURE = 5.0  #: least step in standard deviations of what is beside the edge
SHARE = 2.0 / 3.0  #: of the visible length of each edge
SOFTEST = 2.0  #: largest standard deviation of the point spread of the face [px]
_MARGIN = 12.0  #: to the border of the picture [px]
_NEAR, _FAR = 2.5, 12.0  #: where brightness is compared on both sides [px]


def is_plain(view: View) -> bool:
    """Whether at least SHARE of each edge is uncovered, steep enough and in focus."""
    shares = plain_shares(view)
    return min(shares) >= SHARE


def plain_shares(view: View) -> tuple[float, float]:
    """Share of the visible length of the hinge edge and the bottom edge that stands plainly."""
    taking = view.taking
    distance = view.place.distance
    disc = taking.aperture * optics().k[0, 0] * abs(1.0 / distance - 1.0 / (distance + taking.focus))
    if np.hypot(taking.psf, disc / 4.0) > SOFTEST:
        return 0.0, 0.0
    return _share(view, 2), _share(view, 1)


def _share(view: View, axis: int) -> float:
    """Of the edge along y (axis 1, the bottom) or z (axis 2, the hinge)."""
    lens, drawn, pixel = optics(), draw(view), view.place.pixel
    stations = np.arange(2e-3, 0.2, 5e-4)
    side = 3 - axis
    on_edge = np.zeros((len(stations), 3))
    on_edge[:, axis] = stations
    seen = pixels_of(view.place, on_edge)
    inside = (seen[:, 0] > _MARGIN) & (seen[:, 0] < lens.width - _MARGIN)
    inside &= (seen[:, 1] > _MARGIN) & (seen[:, 1] < lens.height - _MARGIN)
    on_edge = on_edge[inside]
    if len(on_edge) < 40:
        return 0.0
    depths = np.arange(-_FAR, _FAR + 0.25, 0.5)
    points = np.repeat(on_edge[:, None], len(depths), axis=1)
    points[:, :, side] = depths * pixel
    at = pixels_of(view.place, points.reshape(-1, 3)).reshape(len(on_edge), len(depths), 2).astype(np.float32)
    light, cover, before = (
        cv2.remap(picture.astype(np.float32), at[..., 0], at[..., 1], cv2.INTER_LINEAR)
        for picture in (np.clip(drawn.ideal, 0.0, 1.0), drawn.cover, drawn.before)
    )
    nominal = np.clip(0.5 + depths, 0.0, 1.0)
    close = np.abs(depths) < 6.0
    moved = np.abs(cover - nominal)[:, close & (np.abs(depths) > 0.75)].max(axis=1) > 0.3
    hidden = before[:, close].max(axis=1) > 0.1
    for blot in view.taking.blots:
        hidden |= np.hypot(at[..., 0] - blot.u, at[..., 1] - blot.v).min(axis=1) < blot.radius + blot.soft
    good = _steep(light, depths) & ~moved & ~hidden
    return float(np.mean(good))


def _steep(light: Array, depths: Array) -> Array:
    """Stations, shape (n,) of bool, where light, shape (n, depths), has an edge right at depth 0."""
    count = 12  #: stations over which texture is looked at
    inner, outer = (depths > _NEAR) & (depths < _FAR), (depths < -_NEAR) & (depths > -_FAR)
    next_in, next_out = (depths > 1.5) & (depths < 4.5), (depths < -1.5) & (depths > -4.5)
    wide = light[:, inner].mean(axis=1) - light[:, outer].mean(axis=1)
    close = light[:, next_in].mean(axis=1) - light[:, next_out].mean(axis=1)
    found = np.zeros(len(light), dtype=bool)
    for n in range(len(light)):
        about = slice(max(0, n - count // 2), n + count // 2 + 1)
        texture = max(
            _texture(light[about], inner, depths > 5.0), _texture(light[about], outer, depths < -5.0)
        )
        least = min(abs(wide[n]), abs(close[n])) if wide[n] * close[n] > 0.0 else 0.0
        found[n] = least >= STEP and least >= ABOVE_TEXTURE * texture
    found &= _own_edge(light, depths)
    # An edge that changes its sign from place to place is none for a person either.
    if found.any():
        found &= np.sign(close) == np.sign(np.median(close[found]))
    return found


def _own_edge(light: Array, depths: Array) -> Array:
    """Stations, shape (n,) of bool, where light is steepest right at depth 0, or steeper than on both sides of it.

    A broken arris in shade before a dark background hides the outline: light then rises where the face begins.
    """
    smoothed = cv2.GaussianBlur(light.astype(np.float32), (1, 9), 2.0)
    steep = np.abs(np.gradient(smoothed, depths, axis=1))
    right_there, beside = np.abs(depths) <= 0.75, (np.abs(depths) > 0.75) & (np.abs(depths) <= 1.5)
    peak = steep[:, right_there].max(axis=1)
    own = np.abs(light[:, np.isclose(depths, 1.0)] - light[:, np.isclose(depths, -1.0)])[:, 0]
    found: Array = (peak > steep[:, beside].max(axis=1)) & (own >= 0.5 * STEP)
    return found


def _texture(light: Array, beside: Array, clear: Array) -> float:
    """Standard deviation along an edge, and in both directions where no broken arris is."""
    alongside = float(np.sqrt(light[:, beside].var(axis=0).mean()))
    return max(alongside, float(light[:, beside & clear].std()))
