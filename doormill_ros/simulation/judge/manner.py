"""How the mill cut each feature, from the executed samples: how steeply its middle went down, and which way round.

Two marks are kept while the path is gone through: how deep each point of a lattice over the feature is cut, and each
point just inside its finished wall. Wood under the middle of the mill can only be taken by an edge that reaches it:
flat cuts find none there, for the rim was there before. At the wall a cut climbs where its edge moves against the feed;
the spindle turns clockwise seen from behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.frames import inverse, transform
from doormill_ros.recipes.cutting import Direction
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.executed_path import ExecutedPath
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
        self.cut = np.zeros((len(self.x), len(self.y)))
        self.wall = feature.outline(inset=BESIDE).points(step=LATTICE, chord_error=1e-6)
        self.wall_cut = np.zeros(len(self.wall))
        self.ways = np.zeros(2)  # of the wall: against the feed, with it
        self.wanted = 0 if feature.direction is Direction.CLIMB else 1

    def followed(self, tip: FloatArray, sample: IntArray) -> Manner:
        """Go along the tips (n, 3) [m] of samples (n,)."""
        steepest, steepest_at, wall_at = 0.0, int(sample[0]), -1
        for i in range(len(tip) - 1):
            way = tip[i + 1] - tip[i]
            if sample[i + 1] != sample[i] + 1 or max(tip[i, 2], tip[i + 1, 2]) <= 0.0:
                continue
            count = max(1, math.ceil(float(np.linalg.norm(way)) / STEP))
            slope = math.atan2(float(way[2]), float(np.linalg.norm(way[:2])))
            for k in range(1, count + 1):
                at = tip[i] + way * (k / count)
                if at[2] <= 0.0:
                    continue
                if self._core(at) and slope > steepest:
                    steepest, steepest_at = slope, int(sample[i + 1])
                before = self.ways[1 - self.wanted]
                self._wall(at, way)
                if wall_at < 0 and self.ways[1 - self.wanted] > before:
                    wall_at = int(sample[i + 1])
        enough = float((self.wall_cut > TAKEN).mean()) >= LEAST
        climb = float(self.ways[0] / self.ways.sum()) if enough and self.ways.sum() > 0.0 else math.nan
        return Manner(self.feature.id, steepest, steepest_at, climb, max(wall_at, int(sample[0])))

    def _core(self, at: FloatArray) -> bool:
        """Take what the mill covers; whether its middle took any."""
        columns = slice(*np.searchsorted(self.x, [at[0] - self.radius, at[0] + self.radius]))
        rows = slice(*np.searchsorted(self.y, [at[1] - self.radius, at[1] + self.radius]))
        window = self.cut[columns, rows]
        squared = (self.x[columns, None] - at[0]) ** 2 + (self.y[None, rows] - at[1]) ** 2
        middle: BoolArray = squared < (CORE * self.radius) ** 2
        core = bool((window[middle] < at[2] - TAKEN).any())
        covered = squared < self.radius**2
        window[covered] = np.maximum(window[covered], at[2])
        return core

    def _wall(self, at: FloatArray, way: FloatArray) -> None:
        arm = self.wall - at[:2]
        hit = (arm[:, 0] ** 2 + arm[:, 1] ** 2 < self.radius**2) & (self.wall_cut < at[2] - TAKEN)
        if not hit.any():
            return
        depth = at[2] - self.wall_cut[hit]
        self.wall_cut[hit] = at[2]
        # z x feed points to where a right-handed turn about z moves the edge against the feed.
        side = arm[hit] @ np.array([-way[1], way[0]])
        for number, chosen in enumerate((side > 0.0, side < 0.0)):
            self.ways[number] += float(depth[chosen].sum())
