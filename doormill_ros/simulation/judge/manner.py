"""How the mill cut each feature, from the executed samples: how steeply its middle went down, and which way round.

Two marks are kept while the path is gone through: how deep each point of a lattice over the feature is cut, and each
point just inside its finished wall. Wood under the middle of the mill can only be taken by an edge that reaches it:
flat cuts find none there, for the rim was there before. At the wall a cut climbs where its edge moves against the feed;
the spindle turns clockwise seen from behind it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import inverse, transform
from doormill_ros.recipes.cutting import Direction
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.verdict import BadCut
from doormill_ros.units import deg_to_rad, rad_to_deg

LATTICE = 5e-4  #: distance of the points over a feature [m]
STEP = 4e-4  #: longest way between two looks [m]
CORE = 0.25  #: of the mill's radius: its middle, where only an edge over the centre cuts
BESIDE = 1e-4  #: how far inside the finished wall its points lie [m]
TAKEN = 2e-5  #: less depth than this is none [m]
SLACK = deg_to_rad(2.0)  #: a ramp may be steeper than told by what the robot gives way
MOSTLY = 0.9  #: share of a wall that has to be milled the recipe's way; leads and starts cut both
LEAST = 0.2  #: share of a wall's points that must have been cut for a verdict


@dataclass(frozen=True)
class Manner:
    """How one feature was cut.

    Attributes:
        feature: Identifier in the recipe.
        steepest: Steepest way on which the middle of the mill took wood, 90 degrees for straight down [rad].
        steepest_at: Executed sample of it.
        climb: Share of the finished wall, by its area, that was cut climbing; NaN where too little of it was cut.
        wall_at: Executed sample at which the wall was first cut the other way than the recipe's.
    """

    feature: str
    steepest: float
    steepest_at: int
    climb: float
    wall_at: int


def manners(recipe: Recipe, T_base_door: FloatArray, executed: ExecutedPath) -> list[Manner]:
    """How every feature that was milled was cut.

    Args:
        recipe: The door.
        T_base_door: Where it really stood, shape (4, 4).
        executed: What was done.
    """
    found = []
    for feature in recipe.features:
        own = np.flatnonzero(executed.feature == feature.id)
        if len(own) > 1:
            T = inverse(T_base_door @ recipe.T_door_feature(feature)) @ executed.T_base_tool[own]
            if np.median(T[:, 2, 2]) < 0.0:  # from the far side
                depth = feature.cut_depth(recipe.size)
                T = transform(np.diag([-1.0, 1.0, -1.0]), np.array([0.0, 0.0, depth])) @ T
            found.append(_Marks(feature).followed(T[:, :3, 3], own))
    return found


def bad_cuts(recipe: Recipe, T_base_door: FloatArray, executed: ExecutedPath) -> list[BadCut]:
    """Mills that went straight down and cannot, and walls that were not milled the recipe's way.

    Args:
        recipe: The door.
        T_base_door: Where it really stood, shape (4, 4).
        executed: What was done.
    """
    bad = []
    for manner in manners(recipe, T_base_door, executed):
        feature = recipe.feature(manner.feature)
        tool = feature.tool
        if not tool.centre_cutting and manner.steepest > tool.max_ramp + SLACK:
            said = (
                f"{tool.name}, which does not cut with its middle, went down at {rad_to_deg(manner.steepest):.0f} deg "
                f"where {rad_to_deg(tool.max_ramp):.0f} are allowed"
            )
            bad.append(_bad(said, manner.steepest_at, recipe, T_base_door, executed, steep=True))
        climbing = feature.direction is Direction.CLIMB
        share = manner.climb if climbing else 1.0 - manner.climb
        if share < MOSTLY:
            said = f"{feature.direction.value} milling was asked for, {share:.0%} of the wall was milled so,"
            bad.append(_bad(said, manner.wall_at, recipe, T_base_door, executed, steep=False))
    return bad


def _bad(
    said: str, sample: int, recipe: Recipe, T_base_door: FloatArray, executed: ExecutedPath, steep: bool
) -> BadCut:
    place = (inverse(T_base_door) @ executed.T_base_tool[sample])[:3, 3]
    feature = recipe.feature(str(executed.feature[sample]))
    into = recipe.T_door_feature(feature)
    return BadCut(
        motion=int(executed.motion[sample]) + 1,
        feature=feature.id,
        time=float(executed.time[sample]),
        depth=max(0.0, float((place - into[:3, 3]) @ into[:3, 2])),
        place=place,
        samples=frozenset({sample}),
        said=said,
        steep=steep,
    )


class _Marks:
    """How deep a feature is cut at its points; feature axes, z into the wood."""

    def __init__(self, feature: Feature) -> None:
        self.feature, self.radius = feature, feature.tool.radius
        shape = feature.shape
        self.half = np.array([shape.width, shape.length]) / 2.0
        counts = np.ceil(2.0 * self.half / LATTICE).astype(int) + 1
        self.x, self.y = (np.linspace(-h, h, n) for h, n in zip(self.half, counts, strict=True))
        self.pitch = [2.0 * h / (n - 1) for h, n in zip(self.half.tolist(), counts.tolist(), strict=True)]
        self.cut = np.zeros((len(self.x), len(self.y)))
        self.wall_x, self.wall_y = (
            feature.outline(inset=BESIDE).points(step=LATTICE, chord_error=1e-6).T.copy()
        )
        self.wall_cut = np.zeros(len(self.wall_x))
        self.ways = np.zeros(2)  # of the wall: against the feed, with it
        self.wanted = 0 if feature.direction is Direction.CLIMB else 1

    def followed(self, tip: FloatArray, sample: IntArray) -> Manner:
        """Go along the tips (n, 3) [m] of samples (n,)."""
        steepest, steepest_at, wall_at = 0.0, int(sample[0]), -1
        ways = np.diff(tip, axis=0)
        aside = np.hypot(ways[:, 0], ways[:, 1])
        counts = np.maximum(np.ceil(np.hypot(aside, ways[:, 2]) / STEP).astype(int), 1).tolist()
        slopes = np.arctan2(ways[:, 2], aside).tolist()
        steps = np.flatnonzero((np.diff(sample) == 1) & (np.maximum(tip[:-1, 2], tip[1:, 2]) > 0.0))
        for i in steps.tolist():
            start, way = tip[i].tolist(), ways[i].tolist()
            for k in range(1, counts[i] + 1):
                x, y, z = (s + w * (k / counts[i]) for s, w in zip(start, way, strict=True))
                if z <= 0.0:
                    continue
                if self._core(x, y, z) and slopes[i] > steepest:
                    steepest, steepest_at = slopes[i], int(sample[i + 1])
                before = self.ways[1 - self.wanted]
                self._wall(x, y, z, way)
                if wall_at < 0 and self.ways[1 - self.wanted] > before:
                    wall_at = int(sample[i + 1])
        enough = float((self.wall_cut > TAKEN).mean()) >= LEAST
        climb = float(self.ways[0] / self.ways.sum()) if enough and self.ways.sum() > 0.0 else math.nan
        return Manner(self.feature.id, steepest, steepest_at, climb, max(wall_at, int(sample[0])))

    def _core(self, x: float, y: float, z: float) -> bool:
        """Take what the mill covers at a place [m]; whether its middle took any."""
        columns, rows = self._near(0, x), self._near(1, y)
        window = self.cut[columns, rows]
        squared = (self.x[columns, None] - x) ** 2 + (self.y[None, rows] - y) ** 2
        core = bool(((window < z - TAKEN) & (squared < (CORE * self.radius) ** 2)).any())
        np.maximum(window, z, out=window, where=squared < self.radius**2)
        return core

    def _near(self, axis: int, at: float) -> slice:
        """All points along an axis that the mill may cover, and one more to each side."""
        first = (at - self.radius + float(self.half[axis])) / self.pitch[axis]
        return slice(
            max(0, math.floor(first)), max(0, math.ceil(first + 2.0 * self.radius / self.pitch[axis]) + 1)
        )

    def _wall(self, x: float, y: float, z: float, way: Sequence[float]) -> None:
        """Take what the mill covers of the finished wall, on a way to a place [m]."""
        aside, along = self.wall_x - x, self.wall_y - y
        hit = np.flatnonzero((aside**2 + along**2 < self.radius**2) & (self.wall_cut < z - TAKEN))
        if not hit.size:
            return
        depth = z - self.wall_cut[hit]
        self.wall_cut[hit] = z
        # z x feed points to where a right-handed turn about z moves the edge against the feed.
        side = along[hit] * way[0] - aside[hit] * way[1]
        for number, chosen in enumerate((side > 0.0, side < 0.0)):
            self.ways[number] += float(depth[chosen].sum())
