"""Forces of a feature's cuts from the wood that each of them removes, in the order in which they are milled."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import shapely

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.correction.cutting_force import (
    COEFFICIENTS,
    advance,
    mean_force,
    plunge_force,
    rim_directions,
    wrench_std,
)
from doormill_ros.frames import apply, inverse
from doormill_ros.recipes.door import R_FEATURE_TOOL, Material
from doormill_ros.toolpath.curves.curve import Arc, points_of, tangents_of
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.plan import Step
from doormill_ros.units import deg_to_rad

TURN = deg_to_rad(90.0)  #: longest arc with one force: the force turns with the feed
PLACES = (1.0 / 6.0, 0.5, 5.0 / 6.0)  #: fractions of a cut at which its engagement is looked at
DESCENT = (np.arange(32) + 0.5) / 32.0  #: fractions of a ramp at which its depth is looked at
INSIDE = 1e-5  #: how far inside its rim a mill looks for wood: a wall that it only brushes is none [m]
FLAT = 0.5  #: slope above which a cut is a plunge
RAMP = 1e-5  #: what goes down less is flat [m]
QUARTER = 12  #: corners of a quarter circle of what was swept
BENDS = 8  #: chords that stand for an arc of the mill's way


def with_forces(steps: Sequence[Step], operation: Operation, material: Material, blend: float) -> list[Step]:
    """The steps of one feature with the wrench of each cut and its standard deviation.

    Long arcs are divided: one step has one wrench, and the force turns with the feed.

    Args:
        steps: Steps of the feature in the order of milling.
        operation: What they mill.
        material: What the door is made of.
        blend: Way over which a change of wrench is spread; arcs within it stay whole [m].
    """
    parts = [part for step in steps for part in (_short(step, blend) if step.cutting else [step])]
    cuts = [part for part in parts if part.cutting]
    milled = iter(_Wood(operation, material, cuts).milled() if cuts else [])
    return [next(milled) if part.cutting else part for part in parts]


def _short(step: Step, blend: float) -> list[Step]:
    curve = step.curve
    ramp = float((curve.end - curve.start) @ step.R_door_tool[:, 2]) > RAMP
    if not isinstance(curve, Arc) or curve.sweep <= TURN or curve.length <= blend or ramp:
        return [step]
    ends = np.linspace(0.0, 1.0, math.ceil(curve.sweep / TURN - 1e-9) + 1)
    return [step.part(float(a), float(b)) for a, b in itertools.pairwise(ends)]


class _Wood:
    """What is left of a feature's wood when each of its n cuts begins.

    The wood lies in layers of depth. What the mill covers along a cut, or along the part of a ramp that goes below the
    middle of a layer, is known beforehand, with the layers that it is taken from. These parts overlap, so a place is
    free where it lies in one of them: their union, the dearest of all, is made only under a mill that goes down.
    """

    def __init__(self, operation: Operation, material: Material, cuts: Sequence[Step]) -> None:
        self.feature, self.coefficients, self.cuts = operation.feature, COEFFICIENTS[material], cuts
        self.radius = self.feature.tool.radius
        self.T_feature_door = inverse(operation.T_door_feature)
        ends = apply(self.T_feature_door, np.array([(cut.curve.start, cut.curve.end) for cut in cuts]))
        self.ends, way = ends, ends[:, 1] - ends[:, 0]  # (n, 2, 3), (n, 3)
        arc = np.array([cut.curve.is_arc for cut in cuts])
        self.falls: BoolArray = way[:, 2] > RAMP
        self.flat: BoolArray = arc | (np.abs(way[:, 2]) <= FLAT * np.hypot(way[:, 0], way[:, 1]))
        ramp = self.flat & self.falls
        # Where a cut ends; of a straight ramp its middle too.
        depths = [*ends[:, 1, 2].tolist(), *(0.5 * ends[ramp & ~arc, :, 2].sum(axis=1)).tolist()]
        self.bottom = np.array(
            sorted({depth for depth in (round(each, 7) for each in depths) if depth > 0.0})
        )
        self.top = np.concatenate([[0.0], self.bottom[:-1]])
        self.reached: BoolArray = self.bottom <= ends[..., 2].max(axis=1)[:, None] + 1e-6  # (n, layers)
        # A layer counts as taken where the tip is below its middle.
        below = 0.5 * (self.top + self.bottom) - ends[:, :1, 2]
        begin = np.where(ramp[:, None], (below / np.where(ramp, way[:, 2], 1.0)[:, None]).clip(0.0, 1.0), 0.0)
        self._take(arc, begin)

    def _take(self, arc: BoolArray, begin: FloatArray) -> None:
        """Find all that is taken.

        Args:
            arc: Cuts along arcs, shape (n,).
            begin: Fraction of each cut at which it begins to take of each layer, shape (n, layers).
        """
        taken = [
            (number, first, reached & (row == first))
            for number, (row, reached) in enumerate(zip(begin, self.reached, strict=True))
            for first in sorted(set(row[reached].tolist()))
        ]
        layers = len(self.bottom)
        self.owner: IntArray = np.array([number for number, _, _ in taken], dtype=int)  # (taken,)
        self.of_layer = np.array([row for _, _, row in taken], dtype=bool).reshape(len(taken), layers)
        chords = np.where(arc[self.owner], BENDS, 1)
        part = np.repeat(np.arange(len(taken)), chords + 1)
        corner = np.arange(len(part)) - np.searchsorted(part, part)
        first = np.array([each for _, each, _ in taken])[part]
        along = first + corner / chords[part] * (1.0 - first)
        lines = shapely.linestrings(self._points(self.owner[part], along), indices=part)
        self.taken = shapely.buffer(lines, self.radius, quad_segs=QUARTER)
        shapely.prepare(self.taken)
        self.bounds = shapely.bounds(self.taken).reshape(-1, 4)

    def _points(self, cut: IntArray, fraction: FloatArray) -> FloatArray:
        """Where the axis of the mill is in the plane of the feature, shapes (k,) each -> (k, 2) [m]."""
        return apply(self.T_feature_door, points_of([each.curve for each in self.cuts], cut, fraction))[:, :2]

    def milled(self) -> list[Step]:
        """The cuts with their wrenches."""
        places, count = np.tile(PLACES, len(self.cuts)), len(PLACES)
        cut = np.repeat(np.arange(len(self.cuts)), count)
        centre = self._points(cut, places).reshape(-1, count, 2)
        tangent = tangents_of([each.curve for each in self.cuts], cut, places)
        feed = (tangent @ self.T_feature_door[:3, :3].T)[:, :2].reshape(-1, count, 2)
        before = np.searchsorted(self.owner, np.arange(len(self.cuts)))
        wrench = np.zeros((len(self.cuts), 6))
        for number, reached in enumerate(self.reached):
            if self.flat[number]:
                wrench[number] += self._across(number, int(before[number]), centre[number], feed[number])
            if self.falls[number] and reached.any():
                wrench[number, 2] -= self._down(number, int(before[number]))
        # Force and moment, each in the axes of the tool.
        turned = (wrench.reshape(-1, 2, 3) @ R_FEATURE_TOOL).reshape(-1, 6)
        std = wrench_std(turned, self.coefficients)
        return [
            cut.changed(wrench_tool=wrench_tool, std_tool=std_tool, bounded=True)
            for cut, wrench_tool, std_tool in zip(self.cuts, turned, std, strict=True)
        ]

    def _across(self, number: int, before: int, centre: FloatArray, feed: FloatArray) -> FloatArray:
        """Mean wrench of a cut across the tool axis at its tip, feature axes, shape (6,) [N, N m].

        Args:
            number: Of the cut.
            before: How much was taken before it.
            centre: Where it is looked at, shape (k, 2) [m].
            feed: Unit direction of travel there, shape (k, 2).
        """
        # The mean over the way of what a ramp cuts of each layer, and of its moment about the tip.
        first, last = self.ends[number, :, 2]
        tip = first + (last - first) * DESCENT if first != last else self.ends[number, :1, 2]
        layers = np.flatnonzero(self.reached[number] & (self.top < tip.max()))
        top = self.top[layers, None]
        cut = (tip - top).clip(0.0, self.bottom[layers, None] - top)  # (l, depths)
        engaged = ~self._free(before, layers, centre, feed)
        cutting, tool = self.feature.cutting, self.feature.tool
        by_depth = mean_force(engaged, feed, cutting.chip(tool), tool.flutes, self.coefficients).mean(axis=1)
        across = cut.mean(axis=1) @ by_depth
        about_x, about_y = (cut * (top + 0.5 * cut - tip)).mean(axis=1) @ by_depth
        return np.array([*across, 0.0, -about_y, about_x, 0.0])

    def _free(self, before: int, layers: IntArray, centre: FloatArray, feed: FloatArray) -> BoolArray:
        """Whether the wood of l layers is gone at the rim of the mill, where it moves on, shape (l, k, DIRECTIONS).

        Args:
            before: How much was taken before.
            layers: Their numbers, shape (l,).
            centre: Axis of the mill at k places, shape (k, 2) [m].
            feed: Unit direction of travel there, shape (k, 2).
        """
        ahead = advance(feed) > 0.0
        x, y = (centre[:, None] + (self.radius - INSIDE) * rim_directions())[ahead].T
        near, of_layer = self._near(before, layers, centre)
        free = np.zeros((len(layers), *ahead.shape), dtype=bool)
        free[:, ahead] = of_layer.T @ shapely.contains_xy(self.taken[near, None], x, y)
        return free

    def _near(self, before: int, layers: IntArray, centre: FloatArray) -> tuple[IntArray, BoolArray]:
        """What was taken of some layers where the mill is, shape (t,), and from which of them, shape (t, l)."""
        low, high = self.bounds[:before, :2], self.bounds[:before, 2:]
        about = (low < centre.max(axis=0) + self.radius) & (high > centre.min(axis=0) - self.radius)
        of_layer = self.of_layer[:before, layers]
        near = np.flatnonzero(about.all(axis=1) & of_layer.any(axis=1))
        return near, of_layer[near]

    def _down(self, number: int, before: int) -> float:
        """Force of what a cut goes down along the tool axis, out of the wood [N]; arguments as of `_across`."""
        end = self.ends[number, 1, :2]
        deepest = np.flatnonzero(self.reached[number])[-1:]
        near, _ = self._near(before, deepest, end[None])
        share = 1.0
        if len(near):
            disc = shapely.Point(end).buffer(self.radius, quad_segs=QUARTER)
            share = disc.difference(shapely.union_all(self.taken[near])).area / disc.area
        tool, cutting, cut = self.feature.tool, self.feature.cutting, self.cuts[number]
        sine = float(self.ends[number, 1, 2] - self.ends[number, 0, 2]) / max(cut.curve.length, 1e-9)
        chip = sine * cut.speed / (tool.flutes * cutting.spindle(tool) / (2.0 * math.pi))
        return plunge_force(share, self.radius, chip, tool.flutes, self.coefficients)
