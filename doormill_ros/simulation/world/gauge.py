"""A gauge on a milled door: at which depth along the normal of each nominal point the wood begins.

Written apart from `simulation/judge/milled_part.py`, which takes the distance to the tool's way: here the wall is where
the furthest of all discs of the tool ends along the normal, and a floor is the deepest tip above its point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import cKDTree

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import apply, inverse
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath

WALL_STEP = 3e-3  #: distance of points along a wall [m]
FLOOR_STEP = 8e-3  #: distance of points on a floor [m]
MARGIN = 2e-3  #: floors are measured so far from their walls [m]
RANGE = 3e-3  #: how far from its nominal place the gauge looks for a surface [m]
#: The tool's way is looked at in such steps [m]: 0.15 um between two discs of an 8 mm radius
PATH_STEP = 1e-4
NOISE = 1e-5  #: standard deviation of one deviation [m]


@dataclass(frozen=True, eq=False)
class GaugedPoints:
    """Measured points of a door; the columns of points.csv.

    Attributes:
        feature: Name in the recipe of each of n points.
        surface: "wall" or "floor", n of them.
        point: Nominal points, door frame, shape (n, 3) [m].
        normal: From the pocket into the wood, door axes, shape (n, 3).
        deviation: Shape (n,) [m]; positive where too much wood is gone.
    """

    feature: tuple[str, ...]
    surface: tuple[str, ...]
    point: FloatArray
    normal: FloatArray
    deviation: FloatArray


def gauge(
    recipe: Recipe,
    T_base_door: FloatArray,
    path: ExecutedPath,
    rng: np.random.Generator,
    noise: float = NOISE,
) -> GaugedPoints:
    """Measure walls at half their depth and floors.

    Points without a surface in the gauge's range are left out: nothing was milled there, or another feature.

    Args:
        recipe: What should have been milled.
        T_base_door: Where the door stood while it was milled, shape (4, 4).
        path: What the tool did.
        rng: Of the gauge's noise.
        noise: Its standard deviation [m].
    """
    parts = []
    for feature in recipe.features:
        T_door_feature = recipe.T_door_feature(feature)
        rows = np.flatnonzero(path.cutting & (path.feature == feature.id))
        pose = inverse(T_base_door @ T_door_feature) @ path.T_base_tool[rows]
        depth, radius = feature.cut_depth(recipe.size), feature.tool.radius
        tips, axes = _fine(pose, rows)
        point, normal = wall_points(feature)
        measured = [
            ("wall", point, normal, 0.5 * depth, _walls(point, normal, tips, axes, 0.5 * depth, radius))
        ]
        if not feature.through:
            point = _floor_points(recipe, feature)
            found = _floors(point, tips, axes, radius) - depth
            found[np.abs(found) > RANGE] = np.nan
            measured.append(("floor", point, np.zeros((len(point), 2)), depth, found))
        for surface, point, normal, z, found in measured:
            kept = np.isfinite(found)
            place = np.column_stack([point, np.full(len(point), z)])[kept]
            into = np.column_stack([normal, np.full(len(point), surface == "floor")])[kept]
            parts.append(
                (
                    feature.id,
                    surface,
                    apply(T_door_feature, place),
                    into @ T_door_feature[:3, :3].T,
                    found[kept],
                )
            )
    deviation = np.concatenate([found for *_, found in parts])
    return GaugedPoints(
        feature=tuple(name for name, *_, found in parts for _ in found),
        surface=tuple(surface for _, surface, *_, found in parts for _ in found),
        point=np.concatenate([point for _, _, point, _, _ in parts]),
        normal=np.concatenate([normal for _, _, _, normal, _ in parts]),
        deviation=deviation + noise * rng.standard_normal(len(deviation)),
    )


def wall_points(feature: Feature) -> tuple[FloatArray, FloatArray]:
    """Points along the outline and normals into the wood, feature frame, shapes (n, 2)."""
    points, normals = [], []
    for segment in feature.outline().segments:
        count = max(1, int(np.ceil(segment.length / WALL_STEP)))
        share = (np.arange(count) + 0.5) / count
        step = 1e-4 / count
        way = segment.points(share + step) - segment.points(share - step)
        points.append(segment.points(share))
        # Outlines run clockwise round the pocket: the wood is to the left.
        normals.append(np.column_stack([-way[:, 1], way[:, 0]]) / np.linalg.norm(way, axis=1)[:, None])
    return np.concatenate(points), np.concatenate(normals)


def _floor_points(recipe: Recipe, feature: Feature) -> FloatArray:
    """Points on the floor, without the mouth of what goes deeper there; feature frame, shape (n, 2) [m]."""
    outline = shapely.Polygon(feature.outline().points())
    floor = outline.buffer(-MARGIN)
    for other in recipe.features:
        if other.id == feature.belongs_to:
            T = inverse(recipe.T_door_feature(feature)) @ recipe.T_door_feature(other)
            mouth = other.outline().points()
            mouth = apply(T, np.column_stack([mouth, np.zeros(len(mouth))]))[:, :2]
            floor = floor.difference(shapely.Polygon(mouth).buffer(MARGIN))
    low_x, low_y, high_x, high_y = outline.bounds
    axes = [
        (low + high) / 2.0 + FLOOR_STEP * np.arange(-n, n + 1)
        for low, high in ((low_x, high_x), (low_y, high_y))
        for n in [int((high - low) / 2.0 / FLOOR_STEP)]
    ]
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    inside: FloatArray = places[shapely.contains_xy(floor, places[:, 0], places[:, 1])]
    return inside


def _fine(pose: FloatArray, rows: IntArray) -> tuple[FloatArray, FloatArray]:
    """Tips and axes along the way, at most PATH_STEP apart; shapes (m, 3).

    Args:
        pose: Of the tool in the feature frame, shape (n, 4, 4).
        rows: Numbers of the samples, shape (n,): only of neighbours is the way between them known.
    """
    if not len(pose):
        return np.zeros((0, 3)), np.zeros((0, 3))
    ends = pose[:, :3, 2:].transpose(0, 2, 1)  # axis and tip, shape (n, 2, 3)
    parts = np.ceil(np.linalg.norm(np.diff(ends[:, 1], axis=0), axis=1) / PATH_STEP).astype(int)
    parts = np.where(np.diff(rows) == 1, np.maximum(parts, 1), 1)
    stretch = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(stretch)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[stretch]
    between = ends[stretch] + share[:, None, None] * (ends[stretch + 1] - ends[stretch])
    every = np.concatenate([between, ends[-1:]])
    return every[:, 1], every[:, 0]


def _walls(
    point: FloatArray, normal: FloatArray, tips: FloatArray, axes: FloatArray, depth: float, radius: float
) -> FloatArray:
    """How far along its normal from each point the discs at a depth reach, shape (n,) [m]; NaN beyond the range."""
    past = (tips[:, 2] - depth) / axes[:, 2]
    deep = past >= 0.0
    centre = (tips[:, :2] - past[:, None] * axes[:, :2])[deep]
    found = np.full(len(point), np.nan)
    if not len(centre):
        return found
    ideal = point - radius * normal
    for i, near in enumerate(cKDTree(centre).query_ball_point(ideal, RANGE)):
        if near:
            off = centre[near] - ideal[i]
            along = off @ normal[i]
            across = off @ np.array([-normal[i, 1], normal[i, 0]])
            found[i] = (along + np.sqrt(radius**2 - across**2) - radius).max()
    return found


def _floors(point: FloatArray, tips: FloatArray, axes: FloatArray, radius: float) -> FloatArray:
    """Depth of the deepest end face over each point, shape (n,) [m]; NaN where there was none."""
    found = np.full(len(point), np.nan)
    if not len(tips):
        return found
    for i, near in enumerate(cKDTree(tips[:, :2]).query_ball_point(point, radius)):
        if near:
            # The end face is square to the tool's axis.
            off = point[i] - tips[near, :2]
            slope = np.sum(off * axes[near, :2], axis=1) / axes[near, 2]
            found[i] = (tips[near, 2] - slope).max()
    return found
