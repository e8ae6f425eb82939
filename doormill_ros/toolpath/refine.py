"""Divide the cuts where one corrected segment would not follow the loaded robot."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.toolpath.curve import Arc, Line
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import Correction
from doormill_ros.toolpath.stations import FRACTIONS

FLAT_ARC = 0.5  #: arcs flatter than this share of the largest step of the correction become lines
BLEND_SAMPLES = 80  #: places in one blend at which its progress is looked at


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


def bends(correction: FloatArray, arc: BoolArray) -> FloatArray:
    """How far the corrections along steps leave what a MoveL or MoveC interpolates.

    Args:
        correction: Translation from nominal to corrected pose at the stations, shape (m, k, 3) [m].
        arc: True for steps with a circle point in the middle, shape (m,).

    Returns:
        Largest distance, shape (m,) [m].
    """
    t = FRACTIONS[None, :, None]
    first, middle, last = correction[:, :1], correction[:, 2:3], correction[:, -1:]
    straight = first + t * (last - first)
    round_ = straight + 4.0 * t * (1.0 - t) * (middle - 0.5 * (first + last))
    follow = np.where(arc[:, None, None], round_, straight)
    largest: FloatArray = np.linalg.norm(correction - follow, axis=-1).max(axis=1)
    return largest


def divide(
    steps: Sequence[Step], correction: FloatArray, settings: Correction, blend: bool = True
) -> Division:
    """Divide cuts, and spread their changes of wrench.

    Where one segment of an outline follows another the wrench changes, and with it the
    correction. The tool's engagement changes over about its radius, so the wrench is blended
    over that length, in steps that move the correction by no more than the setting.

    Args:
        steps: The plan.
        correction: Translation of the correction at every station, shape (m, k, 3) [m].
        settings: Limits.
        blend: Spread the changes of wrench too.
    """
    arc = np.array([step.curve.is_arc for step in steps])
    bend = bends(correction, arc)
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
        for index, first, last, wrench in _divide_run(
            steps[i:j], correction[i:j], bend[i:j], settings, blend
        ):
            for a, b, part in _stretches(steps[i + index], first, last, settings):
                new.append(part.changed(wrench_tool=wrench))
                parent.append(i + index)
                span.append((a, b))
        i = j
    return Division(tuple(new), np.array(parent), np.array(span))


def _divide_run(
    run: Sequence[Step], correction: FloatArray, bend: FloatArray, settings: Correction, blend: bool
) -> list[tuple[int, float, float, FloatArray]]:
    """One uninterrupted cut: (step, first, last, wrench) of every part."""
    length = np.array([step.curve.length for step in run])
    border = np.concatenate([[0.0], np.cumsum(length)])  # (m + 1,) [m]
    jump = np.linalg.norm(correction[1:, 0] - correction[:-1, -1], axis=-1)  # (m - 1,)
    changes = border[1:-1][jump > settings.step] if blend else np.zeros(0)
    cuts = _blend_cuts(changes, _Blend(border, correction.mean(axis=1), settings.blend), settings)
    wrench = _Blend(border, np.array([step.wrench_tool for step in run]), settings.blend)
    cut_at: list[tuple[int, float, float]] = []
    for i in range(len(run)):
        inside = cuts[(cuts > border[i]) & (cuts < border[i + 1])] - border[i]
        # A curved correction leaves its chord with the square of the length.
        count = math.ceil(math.sqrt(bend[i] / settings.bend)) if bend[i] > settings.bend else 1
        inside = np.concatenate([inside, length[i] * np.arange(1, count) / count])
        at = _apart(np.sort(inside), length[i], settings.shortest)
        cut_at += [(i, first, last) for first, last in itertools.pairwise(at)]
    index, first, last = (np.array(column) for column in zip(*cut_at, strict=True))
    middle = border[index] + 0.5 * (first + last)
    near = np.abs(middle[:, None] - changes) < 0.5 * settings.blend  # (parts, changes)
    blended = wrench.mean(border[index] + first, border[index] + last)
    own = np.array([step.wrench_tool for step in run])[index]
    load = np.where(near.any(axis=1)[:, None], blended, own)
    share = 1.0 / length[index]
    return list(zip(index.tolist(), (first * share).tolist(), (last * share).tolist(), load, strict=True))


def _blend_cuts(changes: FloatArray, correction: _Blend, settings: Correction) -> FloatArray:
    """Places at which the blended correction has moved on by one step, shape (n,) [m].

    Args:
        changes: Places where segments with different loads meet [m].
        correction: The correction of each segment, to be blended.
        settings: Step and length of the blend.
    """
    if not len(changes):
        return np.zeros(0)
    window = settings.blend * (np.arange(BLEND_SAMPLES + 1) / BLEND_SAMPLES - 0.5)
    s = np.unique(changes[:, None] + window)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(correction.at_places(s), axis=0), axis=1))])
    steps = np.floor(way / settings.step)
    passed = s[1:][np.diff(steps) > 0]
    return np.concatenate([changes - 0.5 * settings.blend, passed, changes + 0.5 * settings.blend])


def _stretches(
    step: Step, first: float, last: float, settings: Correction
) -> list[tuple[float, float, Step]]:
    """A part of a step, as lines where it is so flat an arc that its correction could bend it over."""
    part = step if (first, last) == (0.0, 1.0) else step.part(first, last)
    curve = part.curve
    if not isinstance(curve, Arc) or curve.height > FLAT_ARC * settings.step:
        return [(first, last, part)]
    count = max(1, math.ceil(math.sqrt(curve.height / settings.bend)))
    cuts = np.linspace(0.0, 1.0, count + 1)
    ends = curve.points(cuts)
    lines = []
    for k in range(count):
        name, zone = (part.name, part.zone) if k == count - 1 else ("", "z0")
        line = part.changed(
            kind=MotionKind.LINEAR, curve=Line(ends[k], ends[k + 1]), name=name, via_name="", zone=zone
        )
        lines.append((first + cuts[k] * (last - first), first + cuts[k + 1] * (last - first), line))
    return lines


def _apart(inside: FloatArray, length: float, shortest: float) -> list[float]:
    """Cuts along a step, its ends included, none closer to the next than allowed [m]."""
    cuts = [0.0]
    for cut in inside:
        if cut - cuts[-1] >= shortest and length - cut >= shortest:
            cuts.append(float(cut))
    return [*cuts, length]


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
        """The blended quantity, shapes (...,) [m] -> (..., d)."""
        return (self._up_to(s + 0.5 * self.width) - self._up_to(s - 0.5 * self.width)) / self.width

    def mean(self, first: FloatArray, last: FloatArray) -> FloatArray:
        """Its mean between places, shapes (p,) [m] -> (p, d)."""
        # Averages of a piecewise linear function: a few samples are close enough.
        samples = first + (last - first) * ((np.arange(8) + 0.5) / 8.0)[:, None]  # (8, p)
        mean: FloatArray = self.at_places(samples).mean(axis=0)
        return mean

    def _up_to(self, s: FloatArray) -> FloatArray:
        return np.stack([np.interp(s, self.at, column) for column in self.integral.T], axis=-1)
