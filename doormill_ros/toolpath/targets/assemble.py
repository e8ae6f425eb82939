"""Put corrected targets and motions together into the program for the controller."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.rapid_limits import MAX_POINTS
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.air.route import check_size
from doormill_ros.toolpath.errors import ProgramSizeError
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.toolpath.stations import Stations
from doormill_ros.toolpath.targets.corrected_targets import corrected_targets
from doormill_ros.toolpath.targets.itinerary import Itinerary, itinerary


def assembled(
    recipe: Recipe,
    plan: Plan,
    stations: Stations,
    q: FloatArray,
    loaded: LoadedRobot,
    robot: Robot,
    settings: PathSettings,
    home: FloatArray,
) -> MillingProgram:
    """Correct every target and write the motions.

    Args:
        recipe: The door.
        plan: Its steps, divided as the correction asks for.
        stations: Nominal poses and wrenches along the steps.
        q: Joint angles at the stations, shape (m, k, 6) [rad].
        loaded: Robot, model and tool.
        robot: The same robot, for its configurations.
        settings: Limits of correction and program.
        home: Where the program begins and ends, shape (6,) [rad].

    Raises:
        ProgramSizeError: There are more targets or points than a controller keeps.
        CorrectionLimitError, CorrectionSettleError, ExpectedErrorError: See `corrected_targets`.
    """
    route = itinerary(plan)
    check_size([stop.feature for stop in route.stops], settings)
    targets = corrected_targets(plan, route, stations, q, loaded, robot, settings)
    points = _points(plan, q[:, -1])
    escapes: list[range] = []
    for escape in plan.escapes:
        escapes.append(range(len(points), len(points) + len(escape)))
        points += escape
    _check_points(points, plan)
    motions = _motions(plan, route, stations, settings.approach.way_speed)
    if escapes:
        # After the last feature its way home is taken; the robot already stands at its first point, spindle off.
        motions += [_through(i, settings.approach.way_speed, 0.0) for i in escapes[-1][1:]]
    return MillingProgram(
        recipe.door_id,
        recipe.version,
        targets,
        tuple(motions),
        tuple(points),
        home,
        tuple(escapes),
        loaded.T_flange_tool,
    )


def steps_of(plan: Plan) -> dict[int, int]:
    """Step of the plan that each motion of its program was made from, those to the points before steps left out."""
    last = np.cumsum([1 + len(step.points) for step in plan.steps]) - 1
    return {motion: step for step, motion in enumerate(last.tolist())}


def _points(plan: Plan, end: FloatArray) -> list[FloatArray]:
    """The points of joint space along the steps, at whose ends the joint angles are `end`, shape (m, 6) [rad]."""
    points: list[FloatArray] = []
    for step, q in zip(plan.steps, end, strict=True):
        points += [*step.points, q] if step.kind is MotionKind.ABSOLUTE else step.points
    return points


def _check_points(points: Sequence[FloatArray], plan: Plan) -> None:
    if len(points) > MAX_POINTS:
        most = max(plan.steps, key=lambda step: len(step.points))
        raise ProgramSizeError(
            f"{most.feature or 'the way home'}: the program has {len(points)} points of joint space, allowed are "
            f"{MAX_POINTS}; mill the door in several runs",
            feature=most.feature,
            found=len(points),
            allowed=MAX_POINTS,
        )


def _motions(plan: Plan, route: Itinerary, stations: Stations, way_speed: float) -> list[Motion]:
    """The motions of every step, those through the points before it first; `way_speed` [m/s] of these."""
    motions: list[Motion] = []
    points = count()
    for step, end, via, wrench in zip(
        plan.steps, route.end.tolist(), route.via.tolist(), stations.wrench, strict=True
    ):
        motions += [_through(next(points), way_speed, step.spindle_speed) for _ in step.points]
        if step.kind is MotionKind.ABSOLUTE:
            motions.append(_through(next(points), step.speed, step.spindle_speed))
            continue
        motions.append(_motion(step, end, via, wrench))
    return motions


def _through(point: int, speed: float, spindle_speed: float) -> Motion:
    """The motion to a point of joint space."""
    return Motion(
        kind=MotionKind.ABSOLUTE,
        target=point,
        via=None,
        speed=speed,
        zone="fine",
        feature="",
        cutting=False,
        spindle_speed=spindle_speed,
    )


def _motion(step: Step, end: int, via: int, wrench: FloatArray) -> Motion:
    """The motion of a step; `wrench` at its stations, base axes, shape (k, 6) [N, N m]."""
    return Motion(
        kind=step.kind,
        target=end,
        via=via if step.kind is MotionKind.CIRCULAR else None,
        speed=step.speed,
        zone=step.zone,
        feature=step.feature,
        cutting=step.cutting,
        wrench=wrench[0] if step.cutting else np.zeros(6),
        wrench_end=wrench[-1] if step.cutting and step.wrench_end is not None else None,
        spindle_speed=step.spindle_speed,
    )
