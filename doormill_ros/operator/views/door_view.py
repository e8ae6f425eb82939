"""The door in hand as the page draws it: what is milled into its faces, how far that is, how well it came out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import apply
from doormill_ros.recipes.door import Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.toolpath.split import split
from doormill_ros.units import m_to_mm

CHORD_ERROR = 5e-4  #: of arcs, which are drawn as lines [m]
NOT_MEASURED = -1.0
NO_NUMBER = -2.0


@dataclass(frozen=True)
class FeatureView:
    """One feature.

    Attributes:
        name: Its id in the recipe.
        face: front, hinge_edge or lock_edge: where it is drawn.
        hidden: It lies on the rear face.
        outline: Its contour, from the left and from the bottom of that face [mm].
        begin, end: When the plan has it milled, from the start of the program [s]; both 0: no plan.
        deviation: How far it is off [m]; NOT_MEASURED: nobody tried; NO_NUMBER: one of its points could not be.
        tolerance: What is allowed [m]; 0: not known.
        robots: Numbers of those of two robots that mill it or a half of it; empty: there is one robot.
        plans: When each of them has it milled, as begin and end.
    """

    name: str
    face: str
    hidden: bool
    outline: tuple[tuple[float, float], ...]
    begin: float = 0.0
    end: float = 0.0
    deviation: float = NOT_MEASURED
    tolerance: float = 0.0
    robots: tuple[int, ...] = ()
    plans: Mapping[int, tuple[float, float]] = field(default_factory=dict)

    def came_to(self, in_work: bool, success: bool | None, shares: Mapping[int, str] | None = None) -> str:
        """A key of the page's texts.

        One of planned, in_work, within, beyond, measured, not_measured, milled, half_milled, not_milled.

        Args:
            in_work: The robot mills the door.
            success: How its run ended; None: it has not.
            shares: What came of the share of each of two robots, by number; planned, in_work, milled or not_milled.
        """
        if self.deviation >= 0.0:
            if self.tolerance <= 0.0:
                return "measured"
            return "within" if self.deviation <= self.tolerance else "beyond"
        if self.deviation == NO_NUMBER:
            return "not_measured"
        if shares and self.robots:
            return together({shares[robot] for robot in self.robots})
        if success is not None:
            return "milled" if success else "not_milled"
        return "in_work" if in_work else "planned"

    def shares(self, shares: Mapping[int, str]) -> list[dict[str, Any]]:
        """JSON-able content of what each of two robots mills of it, none of one robot; shares as of `came_to`."""
        none = (0.0, 0.0)
        return [
            {
                "robot": robot,
                "came_to": shares[robot],
                "begin": self.plans.get(robot, none)[0],
                "end": self.plans.get(robot, none)[1],
            }
            for robot in self.robots
            if robot in shares
        ]


def together(shares: set[str]) -> str:
    """What came of a feature from what came of its halves."""
    if len(shares) == 1:
        return next(iter(shares))
    if "in_work" in shares:
        return "in_work"
    return "half_milled" if "milled" in shares else "not_milled"


@dataclass(frozen=True)
class DoorView:
    """The door of one run; lengths in millimetres."""

    run_id: str
    door_id: str
    width: float
    height: float
    thickness: float
    features: tuple[FeatureView, ...]

    @property
    def robots(self) -> tuple[int, ...]:
        """Which of two robots have something to mill; empty: there is one robot."""
        return tuple(sorted({robot for feature in self.features for robot in feature.robots}))

    def with_plan(self, times: Mapping[str, tuple[float, float]], robot: int | None = None) -> DoorView:
        """When each feature is milled, by which of two robots: begin and end from the start of its program [s]."""

        def planned(feature: FeatureView) -> FeatureView:
            if feature.name not in times:
                return feature
            begin, end = times[feature.name]
            if robot is None:
                return replace(feature, begin=begin, end=end)
            return replace(feature, plans={**feature.plans, robot: (begin, end)})

        return replace(self, features=tuple(map(planned, self.features)))

    def with_measured(self, found: Mapping[str, float], tolerance: float) -> DoorView:
        """How far features are off, NaN for one that could not be measured, and what is allowed, 0 if not known [m]."""
        finite = {name: off if np.isfinite(off) else NO_NUMBER for name, off in found.items()}
        features = (
            replace(feature, deviation=finite[feature.name], tolerance=tolerance or feature.tolerance)
            if feature.name in finite
            else feature
            for feature in self.features
        )
        return replace(self, features=tuple(features))

    def document(
        self, in_work: bool, success: bool | None, shares: Mapping[int, str] | None = None
    ) -> dict[str, Any]:
        """JSON-able content; see `FeatureView.came_to`."""
        return {
            "run_id": self.run_id,
            "door_id": self.door_id,
            "width": self.width,
            "height": self.height,
            "thickness": self.thickness,
            "features": [
                {
                    "name": feature.name,
                    "face": feature.face,
                    "hidden": feature.hidden,
                    "outline": feature.outline,
                    "begin": feature.begin,
                    "end": feature.end,
                    "came_to": feature.came_to(in_work, success, shares),
                    "shares": feature.shares(shares or {}),
                    "deviation": feature.deviation,
                    "tolerance": feature.tolerance,
                }
                for feature in self.features
            ],
        }


def worst_by_feature(points: Iterable[tuple[str, float]]) -> dict[str, float]:
    """How far each feature is off at its worst point [m], from the points' features and deviations [m].

    NaN where a point has no number: the feature may be off by anything there.
    """
    found: dict[str, float] = {}
    for feature, deviation in points:
        found[feature] = max(found.get(feature, 0.0), abs(deviation), key=lambda off: (off != off, off))
    return found


def door_view(recipe: Recipe, run_id: str, settings: PathSettings | None = None) -> DoorView:
    """The door of a recipe before anything is milled; of two robots, with the settings by which they share it."""
    robots = {} if settings is None else robots_of(recipe, settings)
    size = recipe.size
    return DoorView(
        run_id,
        recipe.door_id,
        m_to_mm(size.width),
        m_to_mm(size.height),
        m_to_mm(size.thickness),
        tuple(_feature_view(recipe, feature, robots.get(feature.id, ())) for feature in recipe.features),
    )


def robots_of(recipe: Recipe, settings: PathSettings) -> dict[str, tuple[int, ...]]:
    """Which of two robots mill each feature, by their numbers: both of them a half of some through holes."""
    found: dict[str, tuple[int, ...]] = {}
    for number, share in enumerate(split(recipe, np.eye(4), settings), start=1):
        for own in share.operations:
            found[own.feature.id] = (*found.get(own.feature.id, ()), number)
    return found


def _feature_view(recipe: Recipe, feature: Feature, robots: tuple[int, ...]) -> FeatureView:
    flat = feature.outline().points(step=np.inf, chord_error=CHORD_ERROR)
    x, y, z = apply(recipe.T_door_feature(feature), np.column_stack([flat, np.zeros(len(flat))])).T
    face = feature.side.value if feature.side.is_edge else Side.FRONT.value
    across = {
        Side.HINGE_EDGE.value: recipe.size.thickness - x,
        Side.FRONT.value: y,
        Side.LOCK_EDGE.value: x,
    }
    outline = np.round(m_to_mm(np.column_stack([across[face], z])), 1).tolist()
    points = tuple((u, v) for u, v in outline)
    return FeatureView(feature.id, face, feature.side is Side.REAR, points, robots=robots)


def planned_times(
    places: FloatArray, ends: Sequence[int], speeds: FloatArray, features: Sequence[str], total: float
) -> dict[str, tuple[float, float]]:
    """When each feature is milled by the plan: ways at their feed, stretched to the program's time.

    Args:
        places: Of the targets, shape (n, 3) [m].
        ends: Index of the target where each motion ends, negative where it has none.
        speeds: Of the motions, shape (m,) [m/s].
        features: What each of them mills, empty between features.
        total: Predicted time of the program [s].

    Returns:
        Begin and end by feature, from the start of the program [s].
    """
    clock, before = 0.0, None
    times: dict[str, tuple[float, float]] = {}
    for end, speed, feature in zip(ends, speeds, features, strict=True):
        begun = clock
        if end >= 0:
            if before is not None and speed > 0.0:
                clock += float(np.linalg.norm(places[end] - places[before])) / float(speed)
            before = end
        if feature:
            times[feature] = (times.get(feature, (begun, 0.0))[0], clock)
    stretch = total / clock if clock > 0.0 else 0.0
    return {feature: (begin * stretch, end * stretch) for feature, (begin, end) in times.items()}
