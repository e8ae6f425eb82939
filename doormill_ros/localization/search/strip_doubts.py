"""What a picture must show of lines beside an edge for one of them to be believed."""

from __future__ import annotations

import numpy as np

from doormill_ros.localization.search.edge_layers import CLOSE, TOGETHER, EdgeLayers
from doormill_ros.localization.search.edge_line import EdgeLine
from doormill_ros.localization.search.shade import BESIDE, PITCH, WELL, Surfaces
from doormill_ros.localization.search.strips import ACROSS, BEYOND
from doormill_ros.statistics import running_means

_SEEN_STEP = 0.5  # share of the step along the whole edge that must be between both sides of a line where they are read
_AS_FACE = 0.2  # what differs from the face by less than that share of what its strips do is face
_STRAIGHT = 0.4e-3  # a strip that begins on all its parallels within that is cut off [m]
_APART = 1.5e-3  # lines so far from one another have steps of their own [m]
# Places over which a border shows all of its step, and that are averaged on each side of it.
_BORDER, _SMOOTH = 10, 5
# Light shows less than that share of its change over them, and less than that on what is on the face.
_FADES = 0.5


def ends_face(sight: Surfaces, edge: str, line: EdgeLine, corner: float, end: float) -> bool:
    """Whether what lies outside of a line is rather what lies beyond the face, where that ends, than the face.

    A shadow's border so near to the edge of the face that the two look like one takes that away with it.
    """
    outer, inner = (line.across + sign * np.linspace(*BESIDE, 4) for sign in (-1.0, 1.0))
    tilts = [line.tilt, line.tilt]
    outside, face = sight.levels(edge, [outer, inner], tilts, corner + WELL[0], corner + WELL[1])
    beyond, _ = sight.levels(edge, [outer, inner], tilts, end - 8.0e-3, end - 1.5e-3)
    return abs(outside - face) > 0.5 * abs(beyond - face)


def check_told(one: EdgeLayers, other: EdgeLayers) -> None:
    """Whether brightness and end of every strip of an edge tell where it lies; by now nothing else spoke against it.

    Tape across it is as bright on it as outside. A strip on the face does not reach the corner where that is
    broken off, and seems to go on beyond it where something like it lies behind.

    Raises:
        WrongEdge: One does not.
    """
    last = len(one.strips) - 1
    if one.strips:
        if _no_face(one, other):
            raise one.doubt(0, last + 1)
        inside = [one.strips[last].level]
        if one.width(last) < _APART:
            inside.append(one.face)  # the step of a line holds that of another so near to it
        seen = max(abs(level - one.back) for level in inside)
        hidden = seen < _SEEN_STEP * abs(one.lines[-1].step)
        # Outside of a groove, which ends with the face, lies the face once more.
        strips = max(abs(strip.level - one.deep) for strip in one.strips)
        face_once_more = bool(one.ends[last]) and abs(one.back - one.deep) < _AS_FACE * strips
        if hidden or face_once_more:
            raise one.doubt(last, last + 1)
    for k, strip in enumerate(one.strips):
        if one.like_background(strip) or strip.end is None:
            continue
        short = strip.end > other.lines[0].at(strip.middle) + TOGETHER
        with_face = any(abs(strip.left - line.at(strip.middle)) < TOGETHER for line in other.lines)
        doubtful = (short and not _cut_off(one, k, other)) or (with_face and not one.ends[k])
        if doubtful and not _fades(one, k, other):
            raise one.doubt(k, k + 1)


def _no_face(one: EdgeLayers, other: EdgeLayers) -> bool:
    """Whether inside of the innermost line lies rather background: the edge is further in, and too faint for a line.

    What lies outside of the line is brighter then where beyond the other edge it is darker, or the other way. Nor is
    that a groove, outside of which the face lies once more.
    """
    groove = any(abs(strip.level - one.deep) < _AS_FACE * abs(one.face - one.deep) for strip in one.strips)
    turned = (one.face - one.strips[0].level) * (one.deep - other.back) < 0.0
    return turned and not groove and abs(one.face - other.back) < abs(one.face - one.deep)


def _cut_off(one: EdgeLayers, k: int, other: EdgeLayers) -> bool:
    """Whether strip k begins along a straight line, and the face beside it at its corner: no wood is missing."""
    inner, wide = one.lines[k], one.width(k)
    high, first = inner.at(one.corner), other.lines[0]
    places = high + wide * np.concatenate([ACROSS - 1.0, ACROSS[-1:]])
    start, stop = first.at(high) - CLOSE[1], first.at(high) + WELL[1]
    grey = one.sight.rows(
        one.edge, places - inner.tilt * one.corner, inner.tilt, np.arange(start, stop, PITCH)
    ).astype(float)
    beyond, within = np.median(grey[:, :8], axis=1), np.median(grey[:, -100:], axis=1)
    there = np.abs(grey - within[:, None]) < np.abs(grey - beyond[:, None])
    # What begins is there from then on; the face only for a while, for a groove may cross it further in.
    strip = PITCH * (there.shape[1] - np.argmin(there[:-1, ::-1], axis=1))
    whole = np.convolve(there[-1], np.ones(_BORDER, dtype=int), "valid") == _BORDER
    face = PITCH * int(np.argmax(whole)) if whole.any() else np.inf
    return bool(np.ptp(strip) < _STRAIGHT and face < CLOSE[1] + _STRAIGHT)


def _fades(one: EdgeLayers, k: int, other: EdgeLayers) -> bool:
    """Whether strip k, which is not taken for face, goes over into what lies beyond the other edge by light alone.

    On the face it would have a border where it ends or is broken off, and the face beside it would have the same light.
    """
    if k < one.first or one.ends[k] is not False:
        return False
    inner, low, high = one.lines[k], one.lines[k + 1].at(one.corner), one.lines[k].at(one.corner)
    places = np.concatenate([low + ACROSS * (high - low), high + np.linspace(*BESIDE, ACROSS.size)])
    start = other.lines[-1].at(0.5 * (low + high)) + BEYOND
    along = np.arange(start, one.corner + WELL[1], PITCH)
    grey = one.sight.rows(one.edge, places - inner.tilt * one.corner, inner.tilt, along).astype(np.float32)
    means = running_means(grey, _SMOOTH)
    strip, face = means[: ACROSS.size], means[ACROSS.size :]
    far = strip[:, -1]
    change = np.abs(far - strip[:, 0])
    steepest = np.abs(strip[:, _BORDER:] - strip[:, :-_BORDER]).max(axis=1)
    within = face[:, np.searchsorted(along, one.corner + CLOSE[1]) :].mean(axis=0)
    on_face = np.ptp(np.log(np.maximum(within, 1.0)))
    on_strip = np.log(np.maximum(far, 1.0) / np.maximum(strip[:, 0], 1.0))
    return bool((steepest < _FADES * change).all() and on_face < _FADES * np.abs(on_strip).min())
