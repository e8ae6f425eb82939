"""Forces of a feature's cuts from the wood that each of them removes, in the order in which they are milled."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import shapely

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.correction.cutting_force import (
    COEFFICIENTS,
    mean_force,
    plunge_force,
    rim_directions,
)
from doormill_ros.frames import cross, inverse
from doormill_ros.recipes.door import R_FEATURE_TOOL, Material
from doormill_ros.toolpath.curve import Arc
from doormill_ros.toolpath.operation import Operation
from doormill_ros.toolpath.plan import Step
from doormill_ros.units import deg_to_rad

TURN = deg_to_rad(90.0)  #: longest arc with one force: the force turns with the feed
PLACES = (1.0 / 6.0, 0.5, 5.0 / 6.0)  #: fractions of a cut at which its engagement is looked at
DESCENT = (np.arange(32) + 0.5) / 32.0  #: fractions of a ramp at which its depth is looked at
INSIDE = 1e-5  #: how far inside its rim a mill looks for wood: a wall that it only brushes is none [m]
FLAT = 0.5  #: slope above which a cut is a plunge
RAMP = 1e-5  #: what goes down less is flat [m]
QUARTER = 12  #: corners of a quarter circle of what was swept


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
    return _Wood(operation, material, parts).cut(parts)


def _short(step: Step, blend: float) -> list[Step]:
    curve = step.curve
    ramp = float((curve.end - curve.start) @ step.R_door_tool[:, 2]) > RAMP
    if not isinstance(curve, Arc) or curve.sweep <= TURN or curve.length <= blend or ramp:
        return [step]
    ends = np.linspace(0.0, 1.0, math.ceil(curve.sweep / TURN - 1e-9) + 1)
    return [step.part(float(a), float(b)) for a, b in itertools.pairwise(ends)]


class _Wood:
    """What is left of a feature's wood: for each layer of depth the outline of what was swept."""

    def __init__(self, operation: Operation, material: Material, steps: Sequence[Step]) -> None:
        self.feature, self.coefficients = operation.feature, COEFFICIENTS[material]
        self.T_feature_door = inverse(operation.T_door_feature)
        self.radius = self.feature.tool.radius
        depths = sorted({round(depth, 7) for s in steps if s.cutting for depth in self._depths(s)})
        self.bottom = np.array([depth for depth in depths if depth > 0.0])
        self.top = np.concatenate([[0.0], self.bottom[:-1]])
        self.swept: list[shapely.Geometry] = [shapely.Polygon() for _ in self.bottom]

    def _depths(self, step: Step) -> list[float]:
        """Depths at which a step ends; of a straight ramp that in its middle too."""
        start, end = float(self._at(step.curve.start)[2]), float(self._at(step.curve.end)[2])
        straight = not step.curve.is_arc and self._is_flat(step)
        return [0.5 * (start + end), end] if straight and end - start > RAMP else [end]

    def _is_flat(self, step: Step) -> bool:
        way = self._at(step.curve.end) - self._at(step.curve.start)
        return step.curve.is_arc or bool(abs(way[2]) <= FLAT * float(np.linalg.norm(way[:2])))

    def _at(self, point: FloatArray) -> FloatArray:
        place: FloatArray = self.T_feature_door[:3, :3] @ point + self.T_feature_door[:3, 3]
        return place

    def cut(self, steps: Sequence[Step]) -> list[Step]:
        """Mill all steps, one after the other."""
        return [self._cut(step) if step.cutting else step for step in steps]

    def _cut(self, step: Step) -> Step:
        start, end = self._at(step.curve.start), self._at(step.curve.end)
        reached = np.flatnonzero(self.bottom <= max(start[2], end[2]) + 1e-6)
        flat = self._is_flat(step)
        wrench = np.zeros(6)
        if flat:
            wrench += self._across(step, reached)
        if end[2] - start[2] > RAMP:
            wrench += self._down(step, start, end, reached)
        self._sweep(step, reached)
        R_tool_feature = R_FEATURE_TOOL.T
        force, moment = R_tool_feature @ wrench[:3], R_tool_feature @ wrench[3:]
        # As wide in every direction: grain and wear turn the force as much as they change it.
        sizes = self.coefficients.spread * np.array([np.linalg.norm(force), np.linalg.norm(moment)])
        return step.changed(
            wrench_tool=np.concatenate([force, moment]),
            std_tool=np.repeat(sizes, 3) / math.sqrt(3.0),
            bounded=True,
        )

    def _across(self, step: Step, reached: IntArray) -> FloatArray:
        """Mean wrench of a cut across the tool axis at its tip, feature axes, shape (6,) [N, N m]."""
        cutting, tool = self.feature.cutting, self.feature.tool
        R = self.T_feature_door[:3, :3]
        centre = np.array([self._at(p)[:2] for p in step.curve.points(np.array(PLACES))])  # (k, 2)
        feed = np.array([(R @ step.curve.tangent(t))[:2] for t in PLACES])
        rim = centre[:, None] + (self.radius - INSIDE) * rim_directions()  # (k, d, 2)
        first, last = (float(self._at(p)[2]) for p in (step.curve.start, step.curve.end))
        tip = first + (last - first) * DESCENT
        wrench = np.zeros(6)
        for layer in reached:
            # The mean over the way of what a ramp cuts of the layer, and of its moment about the tip.
            cut = np.clip(tip - self.top[layer], 0.0, self.bottom[layer] - self.top[layer])
            if not cut.any():
                continue
            free = shapely.contains_xy(self.swept[layer], rim[..., 0], rim[..., 1])
            by_depth = mean_force(~free, feed, cutting.chip(tool), tool.flutes, self.coefficients)
            force = np.array([*by_depth.mean(axis=0), 0.0])
            arm = float((cut * (self.top[layer] + 0.5 * cut - tip)).mean())
            wrench[:3] += force * float(cut.mean())
            wrench[3:] += cross(np.array([0.0, 0.0, arm]), force)
        return wrench

    def _down(self, step: Step, start: FloatArray, end: FloatArray, reached: IntArray) -> FloatArray:
        """Wrench of what a cut goes down along the tool axis, feature axes, shape (6,) [N, N m]."""
        if not len(reached):
            return np.zeros(6)
        disc = shapely.Point(end[:2]).buffer(self.radius, quad_segs=QUARTER)
        share = disc.difference(self.swept[reached[-1]]).area / disc.area
        tool, cutting = self.feature.tool, self.feature.cutting
        sine = float(end[2] - start[2]) / max(step.curve.length, 1e-9)
        chip = sine * step.speed / (tool.flutes * cutting.spindle(tool) / (2.0 * math.pi))
        out = plunge_force(share, self.radius, chip, tool.flutes, self.coefficients)
        return np.array([0.0, 0.0, -out, 0.0, 0.0, 0.0])

    def _sweep(self, step: Step, reached: IntArray) -> None:
        shares = np.linspace(0.0, 1.0, 9) if step.curve.is_arc else np.array([0.0, 1.0])
        start, end = float(self._at(step.curve.start)[2]), float(self._at(step.curve.end)[2])
        ramp = end - start > RAMP and self._is_flat(step)
        whole = None if ramp else self._taken(step, shares)
        for layer in reached:
            # A layer counts as taken where the tip is below its middle.
            middle = 0.5 * (self.top[layer] + self.bottom[layer])
            first = float(np.clip((middle - start) / (end - start), 0.0, 1.0)) if ramp else 0.0
            taken = whole if whole is not None else self._taken(step, first + shares * (1.0 - first))
            self.swept[layer] = shapely.union(self.swept[layer], taken)
            shapely.prepare(self.swept[layer])

    def _taken(self, step: Step, shares: FloatArray) -> shapely.Geometry:
        """What the mill covers along a part of a step, at fractions of its length, shape (k,)."""
        points = [self._at(point)[:2] for point in step.curve.points(shares)]
        return shapely.LineString(points).buffer(self.radius, quad_segs=QUARTER)
