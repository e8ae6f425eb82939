"""The door in hand as the page draws it: what is milled into its faces, how far that is, how well it came out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import apply
from doormill_ros.recipes.door import Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.units import m_to_mm

CHORD_ERROR = 5e-4  #: of arcs, which are drawn as lines [m]
NOT_MEASURED = -1.0


@dataclass(frozen=True)
class FeatureView:
    """One feature.

    Attributes:
        name: Its id in the recipe.
        face: front, hinge_edge or lock_edge: where it is drawn.
        hidden: It lies on the rear face.
        outline: Its contour, from the left and from the bottom of that face [mm].
        begin, end: When the plan has it milled, from the start of the program [s]; both 0: no plan.
        deviation: How far it is off [m]; negative: not measured.
        tolerance: What is allowed [m]; 0: not known.
    """

    name: str
    face: str
    hidden: bool
    outline: tuple[tuple[float, float], ...]
    begin: float = 0.0
    end: float = 0.0
    deviation: float = NOT_MEASURED
    tolerance: float = 0.0

    def came_to(self, in_work: bool, success: bool | None) -> str:
        """planned, in_work, within, beyond, measured, milled or not_milled; a key of the page's texts.

        Args:
            in_work: The robot mills the door.
            success: How its run ended; None: it has not.
        """
        if self.deviation >= 0.0:
            if self.tolerance <= 0.0:
                return "measured"
            return "within" if self.deviation <= self.tolerance else "beyond"
        if success is not None:
            return "milled" if success else "not_milled"
        return "in_work" if in_work else "planned"


@dataclass(frozen=True)
class DoorView:
    """The door of one run; lengths in millimetres."""

    run_id: str
    door_id: str
    width: float
    height: float
    thickness: float
    features: tuple[FeatureView, ...]

    def with_plan(self, times: Mapping[str, tuple[float, float]]) -> DoorView:
        """When each feature is milled, begin and end from the start of the program [s]."""
        features = (
            replace(feature, begin=times[feature.name][0], end=times[feature.name][1])
            if feature.name in times
            else feature
            for feature in self.features
        )
        return replace(self, features=tuple(features))

    def with_measured(self, found: Mapping[str, float], tolerance: float) -> DoorView:
        """How far features are off, and what is allowed, 0 where that is not known [m]."""
        features = (
            replace(feature, deviation=found[feature.name], tolerance=tolerance or feature.tolerance)
            if feature.name in found
            else feature
            for feature in self.features
        )
        return replace(self, features=tuple(features))

    def document(self, in_work: bool, success: bool | None) -> dict[str, Any]:
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
                    "came_to": feature.came_to(in_work, success),
                    "deviation": feature.deviation,
                    "tolerance": feature.tolerance,
                }
                for feature in self.features
            ],
        }


def door_view(recipe: Recipe, run_id: str) -> DoorView:
    """The door of a recipe before anything is milled."""
    size = recipe.size
    return DoorView(
        run_id,
        recipe.door_id,
        m_to_mm(size.width),
        m_to_mm(size.height),
        m_to_mm(size.thickness),
        tuple(_feature_view(recipe, feature) for feature in recipe.features),
    )


def _feature_view(recipe: Recipe, feature: Feature) -> FeatureView:
    flat = feature.outline().points(step=np.inf, chord_error=CHORD_ERROR)
    x, y, z = apply(recipe.T_door_feature(feature), np.column_stack([flat, np.zeros(len(flat))])).T
    face = feature.side.value if feature.side.is_edge else Side.FRONT.value
    across = {
        Side.HINGE_EDGE.value: recipe.size.thickness - x,
        Side.FRONT.value: y,
        Side.LOCK_EDGE.value: x,
    }
    outline = np.round(m_to_mm(np.column_stack([across[face], z])), 1).tolist()
    return FeatureView(feature.id, face, feature.side is Side.REAR, tuple((u, v) for u, v in outline))


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
