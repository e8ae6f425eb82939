"""Divide the cuts where one corrected segment would not follow the loaded robot."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.frames import cross
from doormill_ros.toolpath.curves.curve import Arc, Line
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import Correction
from doormill_ros.toolpath.stations import VIA

STRAIGHT = 1e-9  #: sine of the angle at which three points stand on a line
FLAT_ARC = 0.5  #: arcs flatter than this share of the largest step of the correction become lines


@dataclass(frozen=True, eq=False)
class Division:
    """A divided plan.

    Attributes:
        steps: The new steps.
        parent: Index of the step each one is a part of, shape (m,).
        span: First and last fraction of the parent, shape (m, 2).
    """

    steps: tuple[Step, ...]
    parent: IntArray
    span: FloatArray


def bends(places: FloatArray, arc: BoolArray) -> FloatArray:
    """How far the tool's places along steps lie beside the MoveL or MoveC through their ends and middles.

    Args:
        places: Where the tool has to be sent at the stations, shape (m, k, 3) [m].
        arc: True for steps with a circle point in the middle, shape (m,).

    Returns:
        Largest distance, shape (m,) [m].
    """
    way = places - places[:, :1]
    via, end = way[:, VIA], way[:, -1]
    normal = cross(via, end)
    square = np.einsum("mi,mi->m", normal, normal)[:, None]
    bent = arc & (square[:, 0] > (STRAIGHT * np.einsum("mi,mi->m", end, end)) ** 2)
    beside = np.linalg.norm(cross(way, _unit(end)[:, None]), axis=-1)
    square = np.where(bent[:, None], square, 1.0)
    centre = cross(normal, via) * np.einsum("mi,mi->m", end, end)[:, None]
    centre = (centre + cross(end, normal) * np.einsum("mi,mi->m", via, via)[:, None]) / (2.0 * square)
    arm = way - centre[:, None]
    out = np.einsum("mki,mi->mk", arm, _unit(normal))
    within = np.sqrt(np.maximum(np.einsum("mki,mki->mk", arm, arm) - out**2, 0.0))
    round_ = np.hypot(within - np.linalg.norm(centre, axis=-1)[:, None], out)
    largest: FloatArray = np.where(bent[:, None], round_, beside).max(axis=1)
    return largest


def _unit(vectors: FloatArray) -> FloatArray:
    """Unit vectors, shape (m, 3); zero stays zero."""
    unit: FloatArray = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-15)
    return unit


def divide(
    steps: Sequence[Step], correction: FloatArray, bend: FloatArray, settings: Correction, blend: bool
) -> Division:
    """Divide cuts, and spread their changes of wrench.

    Where one segment of an outline follows another the wrench changes, and with it the correction. The tool's
    engagement changes over about its radius, so the wrench goes evenly from the one to the other over that length.
    No part becomes shorter than a controller can follow at its feed.

    Args:
        steps: The plan.
        correction: Translation of the correction at every station, shape (m, k, 3) [m].
        bend: How far each step is from what a motion interpolates, see `bends`, shape (m,) [m].
        settings: Limits.
        blend: Spread the changes of wrench, else divide where the correction bends.
    """
    new: list[Step] = []
    parent: list[int] = []
    span: list[tuple[float, float]] = []
    i = 0
    while i < len(steps):
        j = i
        while j < len(steps) and steps[j].cutting and steps[j].feature == steps[i].feature:
            j += 1
        if j == i:
            new.append(steps[i])
            parent.append(i)
            span.append((0.0, 1.0))
            i += 1
            continue
        run = steps[i:j]
        parts = _blended(run, correction[i:j], settings) if blend else _straighter(run, bend[i:j], settings)
        for index, first, last, part in parts:
            for a, b, stretch in _stretches(part, first, last, settings):
                new.append(stretch)
                parent.append(i + index)
                span.append((a, b))
        i = j
    return Division(tuple(new), np.array(parent), np.array(span))


Part = tuple[
    int, float, float, Step
]  #: number of the step, its first and last fraction, the step between them


def _blended(run: Sequence[Step], correction: FloatArray, settings: Correction) -> list[Part]:
    """One uninterrupted cut, divided where a change of wrench begins and ends.

    The wall passes and what lies between them are blended apart: the way in is where the tool engages.
    """
    parts: list[Part] = []
    load: FloatArray | None = None
    for _, group in itertools.groupby(range(len(run)), key=lambda i: run[i].wall):
        own = list(group)
        more = _blended_group([run[i] for i in own], correction[own], settings)
        if load is not None:  # no step in the correction
            more[0] = (*more[0][:3], more[0][3].changed(wrench_tool=load))
        parts += [(own[i], first, last, part) for i, first, last, part in more]
        load = parts[-1][3].wrench_at(1.0)
    return parts


def _blended_group(group: Sequence[Step], correction: FloatArray, settings: Correction) -> list[Part]:
    """Steps of a cut whose changes of wrench are spread over the length of a blend."""
    length = np.array([step.curve.length for step in group])
    border = np.concatenate([[0.0], np.cumsum(length)])  # (m + 1,) [m]
    jump = np.linalg.norm(correction[1:, 0] - correction[:-1, -1], axis=-1) > settings.step  # (m - 1,)
    changes = [False, *jump.tolist(), False]
    wrench = _Blend(border, np.array([step.wrench_tool for step in group]), settings.blend)
    knots = [_knots(step, changes[i : i + 2], settings) for i, step in enumerate(group)]
    of_step = np.repeat(np.arange(len(group)), [len(cuts) for cuts in knots])
    places = border[of_step] + length[of_step] * np.concatenate(knots)
    loads = iter(wrench.at_places(places))
    parts: list[Part] = []
    for i, (step, cuts) in enumerate(zip(group, knots, strict=True)):
        load = next(loads)
        for first, last in itertools.pairwise(cuts):
            part = step if len(cuts) == 2 else step.part(first, last)
            begin, load = load, next(loads)
            parts.append((i, first, last, part.changed(wrench_tool=begin, wrench_end=load)))
    return parts


def _knots(step: Step, changes: Sequence[bool], settings: Correction) -> list[float]:
    """Fractions of a step, its ends included, between which its wrench changes evenly.

    Args:
        step: The step.
        changes: Whether the wrench changes where it begins, and where it ends.
        settings: Length of a blend.
    """
    length, half = step.curve.length, 0.5 * settings.blend
    if length <= settings.blend or half < step.speed * settings.segment_time:
        return [0.0, 1.0]  # short enough to be the blend itself
    if all(changes) and length < 2.0 * settings.blend:
        return [0.0, 0.5, 1.0]
    begin, end = changes
    return [0.0, *([half / length] if begin else []), *([1.0 - half / length] if end else []), 1.0]


def _straighter(run: Sequence[Step], bend: FloatArray, settings: Correction) -> list[Part]:
    """One uninterrupted cut, divided where its correction leaves what a motion interpolates."""
    parts: list[Part] = []
    for i, step in enumerate(run):
        # A curved correction leaves its chord with the square of the length.
        count = math.ceil(math.sqrt(bend[i] / settings.bend)) if bend[i] > settings.bend else 1
        cuts = np.linspace(0.0, 1.0, max(1, min(count, _most(step, settings))) + 1)
        for first, last in itertools.pairwise(cuts.tolist()):
            parts.append((i, first, last, step if len(cuts) == 2 else step.part(first, last)))
    return parts


def _most(step: Step, settings: Correction) -> int:
    """How many parts of a step a controller can follow at its feed."""
    return int(step.curve.length / (step.speed * settings.segment_time))


def _stretches(
    part: Step, first: float, last: float, settings: Correction
) -> list[tuple[float, float, Step]]:
    """A part of a step, as lines where it is so flat an arc that its correction could bend it over."""
    curve = part.curve
    if not isinstance(curve, Arc) or curve.height > FLAT_ARC * settings.step:
        return [(first, last, part)]
    count = max(1, min(math.ceil(math.sqrt(curve.height / settings.bend)), _most(part, settings)))
    lines = []
    for a, b in itertools.pairwise(np.linspace(0.0, 1.0, count + 1).tolist()):
        piece = part if count == 1 else part.part(a, b)
        line = piece.changed(
            kind=MotionKind.LINEAR, curve=Line(piece.curve.start, piece.curve.end), via_name=""
        )
        lines.append((first + a * (last - first), first + b * (last - first), line))
    return lines


class _Blend:
    """A quantity along a run: that of its segments, averaged over a sliding length."""

    def __init__(self, border: FloatArray, values: FloatArray, width: float) -> None:
        self.width = width
        # Before the first and after the last segment their values go on.
        self.at = np.concatenate([[border[0] - width], border, [border[-1] + width]])
        values = np.concatenate([values[:1], values, values[-1:]])  # (m + 2, d)
        area = np.cumsum(np.diff(self.at)[:, None] * values, axis=0)
        self.integral = np.concatenate([np.zeros((1, values.shape[1])), area])  # (m + 3, d)

    def at_places(self, s: FloatArray) -> FloatArray:
        """The blended quantity at places of the run, shapes (n,) [m] -> (n, d)."""
        return (self._up_to(s + 0.5 * self.width) - self._up_to(s - 0.5 * self.width)) / self.width

    def _up_to(self, s: FloatArray) -> FloatArray:
        part = self.at.searchsorted(s, side="right") - 1
        slope = (self.integral[part + 1] - self.integral[part]) / (self.at[part + 1] - self.at[part])[:, None]
        up_to: FloatArray = slope * (s - self.at[part])[:, None] + self.integral[part]
        return up_to
