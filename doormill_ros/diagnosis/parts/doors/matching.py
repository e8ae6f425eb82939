"""Finds for every measured point the moment at which the tool cut it.

A mill leaves the envelope of its positions: at a point of a wall the surface lies where the farthest of them reached
along the normal. What moves that position moves the point by as much along the normal, to first order, so posture,
last motions and load of that moment are those that the point tells of.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.parts.doors.cut_points import CutPoints
from doormill_ros.diagnosis.parts.doors.known_force import force_spread
from doormill_ros.diagnosis.parts.doors.recorded_cut import RecordedCut
from doormill_ros.diagnosis.parts.doors.way import Moving, Way, way_through
from doormill_ros.frames import apply, inverse
from doormill_ros.measurements.inspections.inspection import CAMERA, FEATURE, Inspection
from doormill_ros.recipes.features.base import Feature
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.load_case import LoadCase, build_load_case

#: Positions that reach within this of the farthest one may be the farthest once something is wrong [m].
RIVALS = 2.5e-4
#: A joint counts for a point where this turn of it [rad] moves the point by more than that [m].
TURN, MOVED = 1e-4, 4e-6
#: By which rivals may differ in what their assumed load moves the point [m].
LOADS = 2e-5
#: Positions farther from where the mill belongs reach a wall least: one off by as much as no door may be [m].
AROUND = 4e-3
#: Features milled farther beside their place than this are matched again where they are: to first order the envelope
#: moves as the tool does, but 0.4 mm along an arc of 5 mm are 15 um across it [m].
DISPLACED = 5e-5
_ENOUGH = 20  #: points that tell of a feature's place
_FLAT = 0.2  #: share of the best seen direction from which on another is seen
_ABOVE = 1e-4  #: by which the tip may end above a point whose wall it cut [m]


def matched_points(
    inspection: Inspection, cut: RecordedCut, robot: Robot, T_flange_tool: FloatArray, slipped: BoolArray
) -> CutPoints:
    """The points of an inspection with the robot's state where each was cut.

    Points are left out where another last motion or load reached nearly as far: such a point belongs to neither.

    Args:
        inspection: The points.
        cut: The run that milled the door.
        robot: That milled it.
        T_flange_tool: Its tool, shape (4, 4).
        slipped: Points that are left out, shape (n,).

    Raises:
        TrialTableError: A point belongs to no feature of the recipe.
        SetDescriptionError: No point was cut under one load.
    """
    names = {feature.id for feature in cut.recipe.features}
    datum = inspection.datum.removeprefix(FEATURE)
    if datum != inspection.datum and datum not in names:
        raise inspection.refuse("datum", f"is against {datum!r}, the recipe has {', '.join(sorted(names))}")
    for row, name in enumerate(inspection.feature):
        if name not in names:
            raise inspection.refuse_point(
                row, "feature", f"is {name!r}, the recipe has {', '.join(sorted(names))}"
            )
    moving, found = Moving.along(cut), []
    for feature in cut.recipe.features:
        of_feature = np.array(inspection.feature) == feature.id
        cutting = cut.cutting & (np.array(cut.feature) == feature.id)
        if not of_feature.any() or not np.any(cutting & np.any(cut.wrench != 0.0, axis=1)):
            continue
        T_base_feature = cut.T_base_door @ cut.recipe.T_door_feature(feature)
        way = way_through(cut, moving, cutting, T_base_feature, robot, T_flange_tool)
        for wall in (True, False):
            rows = np.flatnonzero(of_feature & (inspection.wall == wall) & ~slipped)
            if len(rows):
                at = _Place(inspection, rows, feature, T_base_feature, cut, robot, T_flange_tool)
                moments = at.moments(way, np.zeros(2))
                points = at.matched(way, moments)
                if wall and datum == CAMERA:
                    # Against another datum nobody knows whether the tool was beside its place or the gauge.
                    off = at.displaced(moments, points)
                    if np.linalg.norm(off) > DISPLACED:
                        points = at.matched(way, at.moments(way, off))
                found.append(points)
    found = [part for part in found if len(part)]
    if not found:
        raise inspection.refuse("run_id", "names a run that cut none of the measured points under one load")
    return CutPoints.joined(found)


@dataclass(frozen=True, eq=False)
class _Moments:
    """When each of n points was cut.

    Attributes:
        at: Number of the position on the way of the tool, shape (n,).
        sent: As in `CutPoints`, -inf for points that were cut nowhere, shape (n,) [m].
        pushed: How far the springs move it along the normal under the assumed load, shape (n,) [m].
        spread: By how much they do that differently at other positions that reached as far, shape (n,) [m].
        turned: Joints whose last motion was another one at such a position, shape (n, 6).
    """

    at: IntArray
    sent: FloatArray
    pushed: FloatArray
    spread: FloatArray
    turned: BoolArray


@dataclass(frozen=True, eq=False)
class _Place:
    """Points `rows` of one surface of one feature, and what it takes to match them."""

    inspection: Inspection
    rows: IntArray
    feature: Feature
    T_base_feature: FloatArray
    cut: RecordedCut
    robot: Robot
    T_flange_tool: FloatArray

    def moments(self, way: Way, off: FloatArray) -> _Moments:
        """When each point was cut.

        Args:
            way: Of the tool through the feature.
            off: How far beside it the tool went, shape (2,) [m].
        """
        wall, radius = self._wall, self.feature.tool.radius
        flat, outward = self._flat
        tree = cKDTree(way.flat[:, :2] + off)
        centre = flat[:, :2] - radius * outward[:, :2] * wall
        n = len(flat)
        at, sent, pushed, spread = np.zeros(n, dtype=int), np.full(n, -np.inf), np.zeros(n), np.zeros(n)
        turned = np.zeros((n, 6), dtype=bool)
        for i, near in enumerate(tree.query_ball_point(centre, AROUND if wall else radius)):
            rivals = np.array(near, dtype=int)
            reach = (
                _reach(flat[i] - [*off, 0.0], outward[i], way, rivals, radius, wall) - outward[i, :2] @ off
            )
            given = way.moved[rivals] @ outward[i]
            if not np.isfinite(reach).any():
                continue
            best = int((reach + given).argmax())
            at[i], sent[i], pushed[i] = rivals[best], reach[best], given[best]
            close = reach + given > reach[best] + given[best] - RIVALS
            spread[i] = np.ptp(given[close])
            turned[i] = np.any(way.direction[rivals[close]] != way.direction[at[i]], axis=0)
        return _Moments(at, sent, pushed, spread, turned)

    def displaced(self, moments: _Moments, points: CutPoints) -> FloatArray:
        """By how much the whole feature was milled beside its place, in its plane, shape (2,) [m].

        Args:
            moments: When each point was cut.
            points: Those that tell of a single moment; where these are few all count, which tell it well enough.
        """
        cut = np.isin(self.rows, points.row)
        if cut.sum() < _ENOUGH:
            cut = np.isfinite(moments.sent)
        if cut.sum() < _ENOUGH:
            return np.zeros(2)
        left = self.inspection.deviation[self.rows] - moments.sent - moments.pushed
        return np.asarray(np.linalg.lstsq(self._flat[1][cut, :2], left[cut], rcond=_FLAT)[0], dtype=float)

    @property
    def _wall(self) -> bool:
        return bool(self.inspection.wall[self.rows[0]])

    @cached_property
    def _flat(self) -> tuple[FloatArray, FloatArray]:
        """Points [m] and normals, feature axes, shape (n, 3) each."""
        T_feature_door = inverse(self.T_base_feature) @ self.cut.T_base_door
        normal = self.inspection.normal[self.rows]
        return apply(T_feature_door, self.inspection.point[self.rows]), normal @ T_feature_door[:3, :3].T

    def matched(self, way: Way, moments: _Moments) -> CutPoints:
        """The points, those left out that tell of no single moment."""
        inspection, rows, wall, at = self.inspection, self.rows, self._wall, moments.at
        T_base_door, q, wrench = self.cut.T_base_door, way.q[at], way.wrench[at]
        normal = inspection.normal[rows] @ T_base_door[:3, :3].T
        R_base_tool = (Kinematics(self.robot).forward(q) @ self.T_flange_tool)[:, :3, :3]
        behind = way.flat[at, 2] - self._flat[0][:, 2]
        points = CutPoints(
            point=apply(T_base_door, inspection.point[rows]),
            normal=normal,
            deviation=inspection.deviation[rows],
            sent=moments.sent,
            behind=np.where(wall, behind / np.maximum(way.axis[at, 2], 0.1), 0.0),
            wall=np.full(len(rows), wall),
            q=q,
            direction=way.direction[at],
            wrench=wrench,
            spread=force_spread(self.feature, self.cut.recipe.material, wrench, R_base_tool),
            bounded=np.full(len(rows), not self.feature.force_origin.measured),
            bend=way.bend[at] @ self.T_base_feature[:3, :3].T,
            late=way.late[at] @ self.T_base_feature[:3, :3].T,
            feed=way.feed[at],
            row=rows,
            feature=np.full(len(rows), self.feature.id),
            kind=np.full(len(rows), self.feature.kind),
            tool=np.full(len(rows), self.feature.tool.name),
        )
        felt = cut_case(points, self.robot, self.T_flange_tool)
        single = np.isfinite(moments.sent) & (moments.spread < LOADS)
        for k in range(6):
            counts = np.abs(np.sum(felt.joint_twist(k)[:, :3] * normal, axis=1)) * TURN > MOVED
            single &= ~(counts & moments.turned[:, k])
        return points[single]


def _reach(
    flat: FloatArray, outward: FloatArray, way: Way, at: IntArray, radius: float, wall: bool
) -> FloatArray:
    """How far along its normal a point would be cut by positions of the tool, shape (m,) [m]; -inf for not.

    Args:
        flat: The point, feature axes, shape (3,) [m].
        outward: Its normal, shape (3,).
        way: Positions of the tool.
        at: Which of them, shape (m,).
        radius: Of the mill [m].
        wall: Whether the point lies on a wall.
    """
    up = flat[2] - way.flat[at, 2]
    if not wall:
        high: FloatArray = -up
        return high
    axis = way.axis[at]
    away = way.flat[at, :2] + (up / axis[:, 2])[:, None] * axis[:, :2] - flat[:2]
    along = away @ outward[:2]
    across = away[:, 0] * outward[1] - away[:, 1] * outward[0]
    inside = (np.abs(across) < radius) & (up < _ABOVE)
    return np.where(inside, along + np.sqrt(np.maximum(radius**2 - across**2, 0.0)), -np.inf)


def cut_case(points: CutPoints, robot: Robot, T_flange_tool: FloatArray) -> LoadCase:
    """Loads and geometry of the robot where each point was cut; its points are those of the mill that cut them.

    Args:
        points: n of them.
        robot: That milled.
        T_flange_tool: Its tool, shape (4, 4).
    """
    tip = T_flange_tool[:3, 3] - points.behind[:, None] * T_flange_tool[:3, 2]
    return build_load_case(
        Kinematics(robot),
        points.q,
        points.wrench,
        T_flange_tool[:3, 3],
        points=tip,
        links=np.full(len(points), 6),
        direction=points.direction,
        joint_stiffness=np.array(robot.stiffness),
    )
