"""Whether the texture of the face goes on across a line, on its plane: then the line is drawn on it, and no edge.

Grain, pores and speckle that are seen on both sides in the same places, all along an edge, are of one surface: a
film, a line that was burnt and a groove let them through, and what lies behind the face has its own. A bevel lets them
through as well, but what lies deeper shrinks towards the optical axis, and they with it: that tells how deep it lies.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.shade import BESIDE, PITCH, Surfaces
from doormill_ros.localization.search.strips import ACROSS
from doormill_ros.localization.view import HINGE
from doormill_ros.statistics import NORMAL_STD, median

_BEGIN, _LEAST = 3.0e-3, 40.0e-3  # where it is looked for, from the corner, and over how much at least [m]
_BROAD = 6.0e-3  # light that changes more slowly along an edge is no texture [m]
_LARGEST = 3.0  # standard deviations; what stands out further crosses the edge by itself, as a cable does
_PIECES = 4  # in each of them it must go on
_ALIKE, _EACH = 0.55, 0.35  # correlation all along, and in the worst piece; no other surface had 0.3
_BACK = 0.5  # share of it that may go on over the background: shadows, dust on the lens and stripes of a camera do
_SLANTS = np.array([0.0, 0.4, 0.6, 0.9, 1.3, 1.8, 2.5])  # depths over widths that are tried; 0 is the face
_LEAN = 3  # places by which grain may be displaced that does not run straight across


def goes_on(sight: Surfaces, edge: str, lines: list[EdgeLine], k: int, corner: float) -> bool:
    """Whether the texture inside of the innermost line goes on in strip k as on one plane, and not over the background.

    Args:
        sight: The picture.
        edge: "hinge" or "bottom".
        lines: Along it, from the inside outwards, two at least.
        k: Of the strip, which lies outside of that line.
        corner: Where they meet the other edge [m].
    """
    view = sight.view
    along = np.arange(corner + _BEGIN, view.length(edge), PITCH)
    if along.size * PITCH < _LEAST:
        return False
    near, middle = np.linspace(*BESIDE, ACROSS.size), float(along.mean())
    width = lines[k].at(middle) - lines[k + 1].at(middle)
    within = near if width > BESIDE[0] + BESIDE[1] else ACROSS * width
    from_axis = along + view.distance * float(view.sight(np.zeros(2))[1 if edge == HINGE else 0])
    # What lies as deep as a strip's middle is wide seems so much nearer to the optical axis.
    shrinks = from_axis * float(within.mean()) / view.distance
    if _SLANTS[1] * np.abs(shrinks).max() < PITCH:
        return False
    face, back = (
        _texture(sight.along(edge, line.across + offsets, line.tilt, along))
        for line, offsets in ((lines[0], near), (lines[-1], -near))
    )
    strips = [
        _texture(sight.along(edge, lines[k].across - within, lines[k].tilt, along - slant * shrinks))
        for slant in _SLANTS
    ]
    best = [
        max((float(np.mean(np.roll(strip, by) * face)), by) for by in range(-_LEAN, _LEAN + 1))
        for strip in strips
    ]
    alike, by = best[0]
    pieces = np.array_split(np.roll(strips[0], by) * face, _PIECES)
    return (
        alike > _ALIKE
        and alike == max(best)[0]
        and min(float(piece.mean()) for piece in pieces) > _EACH
        and abs(float(np.mean(face * back))) < _BACK * alike
    )


def _texture(grey: FloatArray) -> FloatArray:
    """What varies along an edge, grey levels (n,), as shares of the brightness nearby; of mean square 1."""
    shade = np.log(np.maximum(grey, 1.0))
    count = round(_BROAD / PITCH) | 1
    broad = np.convolve(np.pad(shade, count // 2, mode="reflect"), np.full(count, 1.0 / count), "valid")
    fine = shade - broad
    most = _LARGEST * NORMAL_STD * median(np.abs(fine))
    np.clip(fine, -most, most, out=fine)
    return np.asarray(fine / max(float(np.sqrt(np.mean(np.square(fine)))), 1e-9), dtype=float)
