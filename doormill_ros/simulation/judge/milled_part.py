"""Measure what a tool really milled: the swept tool against the recipe's geometry.

This is the judge of every run. It knows the recipe's outlines and frames and the executed tool
path, and nothing of how the path was made or which robot followed it.

At a depth below the surface the milled region is the union of the tool's discs along the part of
the path on which the tip is at least that deep. At a point of the recipe's outline the deviation
is the tool radius less the distance to that path: positive where too much wood is gone, negative
where wood is left. It is exact for an executed path of straight stretches between its samples; an
arc sampled every h [m] on radius r reads up to h^2 / 8 r too far inside.

A floor that is not deep enough is the floor's error. Where the tool did not come down to a depth in a pocket, the wall
is off there by the way up to what was milled, or by the way across to it if that is longer; the former is never more
than the floor is off.

The oblong hinge of the thesis is judged like every pocket: its outline is the finished wall, the
numbered points of figure 3.24 lie a tool radius inside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import inverse
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.mills import mill_radius

LAYERS = (0.05, 0.275, 0.5, 0.725, 0.95)  #: fractions of the depth at which walls are measured
#: Step upwards to a depth that was reached, fraction of the depth; every layer is a multiple of it.
RUNG = 0.025
CONTOUR_STEP = 2.5e-4  #: distance of measured points along an outline [m]
PARALLEL = 0.99  #: cosine between tool and feature axis above which the tool cuts with its flank
FLOOR_STEP = 2e-3  #: distance of measured places on the floor [m]
TIP_STEP = 5e-4  #: distance of the tips looked at along a stretch [m]
FLOOR_CHUNK = 256  #: tips looked at in one go
FLAT = 0.5  #: slope of a motion, depth over way along the floor, below which it mills the floor
CLEARED = 5e-4  #: distance from the wall within which leftover wood is the wall's deviation [m]
DISC_SEGMENTS = 64  #: corners of a quarter disc in the milled region, 1 um at a radius of 10 mm


@dataclass(frozen=True, eq=False)
class FeatureResult:
    """How one feature came out.

    Attributes:
        feature: Identifier in the recipe.
        milled: False when the tool never entered the feature, or left a part of a hole's way through.
        station: Way along the outline to each measured point, shape (n,) [m].
        points: The points of the recipe's outline, feature frame, shape (n, 2) [m].
        deviation: Worst deviation of all depths at each point, shape (n,) [m]; positive where too
            much wood is gone, negative where wood is left.
        by_depth: Deviation at each depth, shape (k, n) [m].
        depths: The depths, shape (k,) [m].
        floor: Smallest and largest depth of the floor less the recipe's [m]; zeros for a hole
            that goes through.
        uncleared: Area inside the outline that no tool swept [m^2].
        region: What was milled at the deepest measured depth, or above the shallowest place of a
            floor that is less deep; feature frame.
    """

    feature: str
    milled: bool
    station: FloatArray
    points: FloatArray
    deviation: FloatArray
    by_depth: FloatArray
    depths: FloatArray
    floor: tuple[float, float]
    uncleared: float
    region: shapely.Geometry

    @property
    def max_deviation(self) -> float:
        """Largest magnitude of the deviation along the outline [m]."""
        return float(np.abs(self.deviation).max())

    @property
    def worst(self) -> float:
        """Largest magnitude of the deviation of walls and floor [m]."""
        return max(self.max_deviation, *(abs(off) for off in self.floor))


@dataclass(frozen=True, eq=False)
class MilledPart:
    """How a door came out, feature by feature."""

    features: tuple[FeatureResult, ...]

    @property
    def max_deviation(self) -> float:
        """Largest magnitude of the deviation along any outline [m]."""
        return max(result.max_deviation for result in self.features)

    @property
    def worst(self) -> float:
        """Largest magnitude of the deviation of any wall or floor [m]."""
        return max(result.worst for result in self.features)

    def feature(self, feature_id: str) -> FeatureResult:
        """The result of one feature; raises KeyError when the recipe has none of that name."""
        return {result.feature: result for result in self.features}[feature_id]


def inspect(
    recipe: Recipe,
    T_base_door_true: FloatArray,
    executed: ExecutedPath,
    *,
    others: Sequence[tuple[FloatArray, ExecutedPath]] = (),
    only: Sequence[str] | None = None,
) -> MilledPart:
    """Compare the milled door with its recipe.

    Args:
        recipe: What should have been milled.
        T_base_door_true: Where the door really stood, shape (4, 4).
        executed: What the tool really did. Samples are told apart by their `feature`.
        others: Door pose and executed path of further robots that milled the same door, each in
            its own base frame.
        only: Identifiers of the features to measure; None for all.

    Returns:
        Deviations, positive where too much wood is gone.
    """
    paths = [(T_base_door_true, executed), *others]
    features = [f for f in recipe.features if only is None or f.id in only]
    radii = [mill_radius(recipe, path) for _, path in paths]
    return MilledPart(
        tuple(_measure(recipe, feature, paths, _radius(feature, paths, radii)) for feature in features)
    )


def _measure(
    recipe: Recipe, feature: Feature, paths: Sequence[tuple[FloatArray, ExecutedPath]], radius: float
) -> FeatureResult:
    depth = feature.cut_depth(recipe.size)
    points = feature.outline().points(step=CONTOUR_STEP, chord_error=1e-7)
    station = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    ways = []
    for T_base_door, path in paths:
        own = np.char.equal(path.feature, feature.id)
        T_feature_base = inverse(T_base_door @ recipe.T_door_feature(feature))
        ways.append(_Way(T_feature_base @ path.T_base_tool, own, path.cutting))
    walls = _Walls(points, ways, depth, radius)
    depths = depth * np.array(LAYERS)
    by_depth = np.array([walls.at(share, feature.through) for share in LAYERS])  # (k, n)
    worst = np.abs(by_depth).argmax(axis=0)
    deviation = by_depth[worst, np.arange(len(points))]
    entered = [walls.reached(share) for share in LAYERS]
    inner = shapely.Polygon(points).buffer(-CLEARED)
    # Wood that a wall left is the wall's deviation: no floor is looked for in it, unless there is nothing else.
    within = inner.buffer(min(0.0, float(deviation.min()) + CLEARED / 2.0))
    within = inner if within.is_empty else within
    floor = (0.0, 0.0) if feature.through else _floor(ways, within, depth, radius)
    shallowest = 1.0 + floor[0] / depth
    bottom = LAYERS[-1] if shallowest < 0.5 else min(LAYERS[-1], RUNG * np.floor(shallowest / RUNG))
    region = _swept(walls.stretches(bottom), radius)
    return FeatureResult(
        feature=feature.id,
        milled=all(entered) if feature.through else entered[0],
        station=station,
        points=points,
        deviation=deviation,
        by_depth=by_depth,
        depths=depths,
        floor=floor,
        uncleared=float(inner.difference(region).area),
        region=region,
    )


def _radius(
    feature: Feature, paths: Sequence[tuple[FloatArray, ExecutedPath]], radii: Sequence[FloatArray]
) -> float:
    """Of the mill that was in the spindle at the feature; of its own where nothing was milled [m]."""
    found = np.concatenate(
        [own[np.char.equal(path.feature, feature.id)] for (_, path), own in zip(paths, radii, strict=True)]
    )
    return float(np.median(found)) if len(found) else feature.tool.radius


class _Way:
    """One robot's path in the frame of a feature."""

    def __init__(self, T_feature_tool: FloatArray, own: BoolArray, cutting: BoolArray) -> None:
        """Take the samples.

        Args:
            T_feature_tool: Poses of the tool, shape (n, 4, 4).
            own: Which samples belong to the feature, shape (n,).
            cutting: Which samples cut, shape (n,).
        """
        self.tip = T_feature_tool[:, :3, 3]
        self.axis = T_feature_tool[:, :3, 2]
        # The tool moved straight from sample to sample; both must be this feature's.
        upright = own & (np.abs(self.axis[:, 2]) > PARALLEL)
        self.joined = upright[:-1] & upright[1:]
        step = np.diff(self.tip, axis=0)
        along = np.abs(step[:, 2]) <= FLAT * np.linalg.norm(step[:, :2], axis=1)
        # Stretches that mill a floor, shape (n - 1,).
        self.flat = along & self.joined & cutting[1:] & (self.tip[1:, 2] > 0.0)

    def floor_tips(self) -> FloatArray:
        """Tips along every stretch that mills a floor, at most TIP_STEP apart, shape (m, 3) [m]."""
        start, end = self.tip[:-1][self.flat], self.tip[1:][self.flat]
        parts = np.ceil(np.linalg.norm(end - start, axis=1) / TIP_STEP).astype(int)
        parts = np.maximum(parts, 1)
        stretch = np.repeat(np.arange(len(parts)), parts)
        number = np.arange(len(stretch)) - np.repeat(np.cumsum(parts) - parts, parts)
        share = ((number + 1) / parts[stretch])[:, None]
        tips: FloatArray = start[stretch] + share * (end - start)[stretch]
        return tips

    def at_depth(self, z: float) -> FloatArray:
        """Stretches of the tool axis through the plane at depth z, shape (m, 2, 2) [m]."""
        if not self.joined.any():
            return np.zeros((0, 2, 2))
        ends = []
        for part in (slice(None, -1), slice(1, None)):
            tip, axis = self.tip[part][self.joined], self.axis[part][self.joined]
            # How far the tip is past the plane along its own axis; behind the tip the flank cuts.
            past = (tip[:, 2] - z) / axis[:, 2]  # (m,)
            ends.append((past, tip[:, :2] - past[:, None] * axis[:, :2]))
        keep = (ends[0][0] >= 0.0) | (ends[1][0] >= 0.0)
        (first, start), (last, end) = ((past[keep], centre[keep]) for past, centre in ends)
        # Where the tip enters or leaves the plane on the way, only the deeper part cuts.
        change = np.where(first == last, 1.0, last - first)
        enter = np.clip(np.where(first < 0.0, -first / change, 0.0), 0.0, 1.0)[:, None]
        leave = np.clip(np.where(last < 0.0, -first / change, 1.0), 0.0, 1.0)[:, None]
        way = end - start
        return np.stack([start + enter * way, start + leave * way], axis=1)


class _Walls:
    """The walls of one feature at any depth."""

    def __init__(self, points: FloatArray, ways: Sequence[_Way], depth: float, radius: float) -> None:
        """Take the outline, shape (n, 2) [m], the robots' paths, the recipe's depth [m] and the mill's radius [m]."""
        self.points, self.ways, self.depth, self.radius = points, ways, depth, radius
        self._stretches: dict[int, FloatArray] = {}
        self._deviation: dict[int, FloatArray] = {}

    def stretches(self, share: float) -> FloatArray:
        """Stretches of all tools' axes at a fraction of the depth, shape (m, 2, 2) [m]."""
        rung = round(share / RUNG)
        if rung not in self._stretches:
            z = self.depth * RUNG * rung
            self._stretches[rung] = np.concatenate([way.at_depth(z) for way in self.ways])
        return self._stretches[rung]

    def reached(self, share: float) -> bool:
        """Whether a tool was anywhere so deep."""
        return len(self.stretches(share)) > 0

    def at(self, share: float, through: bool) -> FloatArray:
        """Deviation of each point at a fraction of the depth, shape (n,) [m].

        Args:
            share: The fraction.
            through: Whether the feature has no floor: whatever stands there is the wall's.
        """
        result = self._straight(share).copy()
        if through or not self.reached(LAYERS[0]):
            return result
        # To what was milled leads a way up and one across, of which the longer counts: a floor that is less
        # deep than the recipe's, or in a part of the pocket, is not told as a wall that is further off than it.
        shortest = np.maximum(-result, 0.0)
        for rung in range(1, round((share - LAYERS[0]) / RUNG) + 1):
            up = self.depth * RUNG * rung
            if up >= shortest.max():
                break
            above = self._straight(share - RUNG * rung)
            longer = np.maximum(up, -above)
            nearer = longer < shortest
            shortest[nearer] = longer[nearer]
            result[nearer] = -longer[nearer]
        return result

    def _straight(self, share: float) -> FloatArray:
        rung = round(share / RUNG)
        if rung not in self._deviation:
            self._deviation[rung] = _deviation(self.points, self.stretches(share), self.radius)
        return self._deviation[rung]


def _deviation(points: FloatArray, stretches: FloatArray, radius: float) -> FloatArray:
    """Tool radius less the distance of each point to the nearest stretch, shape (n,) [m]."""
    if not len(stretches):
        # Nothing was milled: the wood stands up to the middle of the feature.
        left: FloatArray = -np.linalg.norm(points - points.mean(axis=0), axis=1)
        return left
    tree = shapely.STRtree(shapely.linestrings(stretches))
    (who, _), distance = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    result = np.empty(len(points))
    result[who] = radius - distance
    return result


def _swept(stretches: FloatArray, radius: float) -> shapely.Geometry:
    """Union of the tool's discs along the stretches."""
    if not len(stretches):
        return shapely.Polygon()
    lines = shapely.line_merge(shapely.multilinestrings(shapely.linestrings(stretches)))
    # A tenth of a micrometre: samples on one straight line become one stretch.
    return shapely.buffer(shapely.simplify(lines, 1e-7), radius, quad_segs=DISC_SEGMENTS)


def _floor(ways: Sequence[_Way], inner: shapely.Geometry, depth: float, radius: float) -> tuple[float, float]:
    """Smallest and largest depth of the finished floor in a region, less the recipe's [m].

    At a place of the floor the deepest tip counts that ever covered it. Only motions along the
    floor are looked at: the way down and the way out leave no floor behind.
    """
    tips = np.concatenate([way.floor_tips() for way in ways])
    tips = tips[np.argsort(-tips[:, 2])]  # deepest first
    places = _grid(inner)
    found = np.full(len(places), -depth)
    open_ = np.arange(len(places))
    for chunk in np.array_split(tips, max(1, len(tips) // FLOOR_CHUNK)):
        if not len(open_) or not len(chunk):
            break
        covered = np.linalg.norm(places[open_, None] - chunk[None, :, :2], axis=-1) < radius
        first, hit = covered.argmax(axis=1), covered.any(axis=1)
        found[open_[hit]] = chunk[first[hit], 2] - depth
        open_ = open_[~hit]
    return float(found.min()), float(found.max())


def _grid(inner: shapely.Geometry) -> FloatArray:
    """Places on the floor, FLOOR_STEP apart, inside a region, shape (n, 2) [m]."""
    low_x, low_y, high_x, high_y = inner.bounds
    x = np.linspace(low_x, high_x, max(3, round((high_x - low_x) / FLOOR_STEP)))
    y = np.linspace(low_y, high_y, max(3, round((high_y - low_y) / FLOOR_STEP)))
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    kept: FloatArray = places[shapely.contains_xy(inner, places[:, 0], places[:, 1])]
    return kept
