"""Put corrected targets and motions together into the program for the controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.configuration import configurations
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.adapt import DIRECTION_ROUNDS
from doormill_ros.toolpath.doubt import check_expected, expected_errors
from doormill_ros.toolpath.errors import CorrectionLimitError, CorrectionSettleError, ProgramSizeError
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.toolpath.route import check_size
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.toolpath.stations import FRACTIONS, VIA, Stations, directions
from doormill_ros.units import m_to_mm

MOST_POINTS = 500  #: points of joint space that a controller keeps
UNSETTLED = 5e-5  #: residual that a step in the model may leave on a target [m]


@dataclass(eq=False)
class Visit:
    """One station at which the program passes a target: step, and station on it."""

    step: int
    station: int


@dataclass(eq=False)
class Stop:
    """A target with every visit to it.

    Attributes:
        name: Name in the program.
        feature: Feature it belongs to.
        visits: Stations at this target; the corrections of the decisive ones are averaged.
    """

    name: str
    feature: str
    visits: list[Visit] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Itinerary:
    """Targets in the order of the target file, and which of them each step uses.

    Attributes:
        stops: The targets.
        end: Index of the target at the end of each step, shape (m,).
        via: Index of the circle point of each step, -1 for a straight one, shape (m,).
    """

    stops: tuple[Stop, ...]
    end: IntArray
    via: IntArray


def itinerary(plan: Plan) -> Itinerary:
    """Number the targets of a plan.

    Named targets that come up again are one target, and so are those of a step that starts where
    the one before ended.
    """
    steps = plan.steps
    stops: list[Stop] = []
    index: dict[str, int] = {}

    def stop(name: str, step: Step, end: bool) -> int:
        if name and name in index:
            return index[name]
        index[name or f"#{len(stops)}"] = len(stops)
        stops.append(Stop(name or str(len(stops) + 1), step.feature))
        return len(stops) - 1

    end, via = np.zeros(len(steps), dtype=int), np.full(len(steps), -1)
    for i, step in enumerate(steps):
        if step.kind is MotionKind.CIRCULAR:
            via[i] = stop(step.via_name, step, False)
            stops[via[i]].visits.append(Visit(i, VIA))
        end[i] = stop(step.name, step, True)
        stops[end[i]].visits.append(Visit(i, -1))
        if i:
            stops[end[i - 1]].visits.append(Visit(i, 0))
    if plan.target_order:
        place = {name: k for k, name in enumerate(plan.target_order)}
        new = np.array([place[s.name] for s in stops])
        ordered: Sequence[Stop] = sorted(stops, key=lambda s: place[s.name])
        return Itinerary(tuple(ordered), new[end], np.where(via >= 0, new[via], -1))
    return Itinerary(tuple(stops), end, via)


def decisive(stop: Stop, steps: Sequence[Step]) -> list[Visit]:
    """The visits whose load a target is corrected for.

    The finished wall counts first, other cuts count where there is no wall, and a target in the
    air is not corrected.
    """
    wall = [v for v in stop.visits if steps[v.step].wall]
    return wall or [v for v in stop.visits if steps[v.step].cutting] or stop.visits[:1]


def shift_along(route: Itinerary, shift: FloatArray) -> FloatArray:
    """What is added at the targets, interpolated along every step.

    Args:
        route: Targets and steps.
        shift: At each target, shape (n, d).

    Returns:
        At the stations of each step, shape (m, k, d).
    """
    t = FRACTIONS[None, :, None]
    start = shift[np.concatenate([route.end[:1], route.end[:-1]])][:, None]  # (m, 1, d)
    end = shift[route.end][:, None]
    straight = start + t * (end - start)
    via = np.where(route.via >= 0, route.via, 0)
    middle = np.where((route.via >= 0)[:, None, None], shift[via][:, None], 0.5 * (start + end))
    first, second = start + 2.0 * t * (middle - start), middle + (2.0 * t - 1.0) * (end - middle)
    round_: FloatArray = np.where(t <= 0.5, first, second)
    return np.where((route.via >= 0)[:, None, None], round_, straight)


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
        ProgramSizeError: There are more targets than a controller keeps.
        CorrectionLimitError: A target would be corrected further than allowed.
        CorrectionSettleError: A target cannot be corrected.
        ExpectedErrorError: What springs and forces leave to chance is more than the tolerance.
    """
    route = itinerary(plan)
    check_size([stop.feature for stop in route.stops], settings)
    place = np.array([[s.visits[0].step, s.visits[0].station] for s in route.stops])
    used = [(i, v.step, v.station) for i, s in enumerate(route.stops) for v in decisive(s, plan.steps)]
    owner, step, station = np.array(used).T
    nominal = stations.T_base_tool[place[:, 0], place[:, 1]]
    at_target = q[place[:, 0], place[:, 1]]
    loads = stations.loads(step, station, directions(q)[step, station])
    found = loaded.corrected_for_all(nominal, at_target, owner, loads)
    for _ in range(DIRECTION_ROUNDS - 1):
        # What counts is how the joints turn on the way that is sent, not on the nominal one.
        sent = q + shift_along(route, found.q - at_target)
        before, loads = loads, stations.loads(step, station, directions(sent)[step, station])
        changed = (loads.direction != before.direction).any(axis=1)
        if not changed.any():
            break
        found = loaded.corrected_again(found, nominal, at_target, owner, loads, changed)
    share = 1.0 / np.bincount(owner)[owner]
    each = loaded.deflection(found.q[owner], loads.wrench, loads.direction)
    mean_wrench, deflection, standing = np.zeros((3, len(route.stops), 6))
    np.add.at(mean_wrench, owner, loads.wrench * share[:, None])
    np.add.at(deflection, owner, each * share[:, None])
    np.add.at(standing, owner, loaded.standing(found.q[owner], loads.direction) * share[:, None])
    wall = np.array([plan.steps[i].wall for i in step])
    moved = (found.T_base_tool - nominal)[:, :3, 3]
    _check_correction(route, moved, standing[:, :3], found.residual, settings)
    expected = expected_errors(loaded, found.q, moved, owner, loads, each, wall)
    check_expected(expected, [(stop.feature, stop.name) for stop in route.stops], settings.checks)
    conf = configurations(robot, found.q)
    targets = tuple(
        Target(stop.name, *arrays)
        for stop, *arrays in zip(
            route.stops,
            nominal,
            found.T_base_tool,
            found.q,
            conf,
            mean_wrench,
            deflection,
            expected.total.tolist(),
            strict=True,
        )
    )
    points: list[FloatArray] = []
    motions: list[Motion] = []
    for i, step in enumerate(plan.steps):
        for point in step.points:
            motions.append(_through(len(points), settings.approach.way_speed, step.spindle_speed))
            points.append(point)
        motions.append(_motion(step, int(route.end[i]), int(route.via[i]), stations.wrench[i]))
    escapes: list[range] = []
    for escape in plan.escapes:
        escapes.append(range(len(points), len(points) + len(escape)))
        points += escape
    if escapes:
        # After the last feature its way home is taken; the robot already stands at its first point, spindle off.
        motions += [_through(i, settings.approach.way_speed, 0.0) for i in escapes[-1][1:]]
    _check_points(points, plan)
    return MillingProgram(
        recipe.door_id, recipe.version, targets, tuple(motions), tuple(points), home, tuple(escapes)
    )


def steps_of(program: MillingProgram) -> dict[int, int]:
    """Step of the plan that each motion to a target was made from."""
    steps = [i for i, motion in enumerate(program.motions) if motion.kind is not MotionKind.ABSOLUTE]
    return {motion: step for step, motion in enumerate(steps)}


def _check_points(points: Sequence[FloatArray], plan: Plan) -> None:
    if len(points) > MOST_POINTS:
        most = max(plan.steps, key=lambda step: len(step.points))
        raise ProgramSizeError(
            f"{most.feature or 'the way home'}: the program has {len(points)} points of joint space, allowed are "
            f"{MOST_POINTS}; mill the door in several runs",
            feature=most.feature,
            found=len(points),
            allowed=MOST_POINTS,
        )


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


def _check_correction(
    route: Itinerary, moved: FloatArray, standing: FloatArray, residual: FloatArray, settings: PathSettings
) -> None:
    """Refuse what no sound model asks for; displacements of shape (n, 3) [m], residuals of shape (n,) [m]."""
    own = np.linalg.norm(standing, axis=1)
    worst, limit = int(own.argmax()), settings.correction.standing
    if own[worst] > limit:
        stop = route.stops[worst]
        raise CorrectionLimitError(
            f"{stop.feature or 'air'}, target {stop.name}: the unloaded tool stands {m_to_mm(own[worst]):.2f} mm off, "
            f"allowed are {m_to_mm(limit):.2f} mm; check the masses of tool and links, where the cell was taught, and "
            "the robot model",
            feature=stop.feature,
            target=stop.name,
            found=float(own[worst]),
            allowed=limit,
        )
    size = np.maximum(np.linalg.norm(moved, axis=1) - own, 0.0)
    worst, limit = int(size.argmax()), settings.correction.limit
    if size[worst] > limit:
        stop = route.stops[worst]
        raise CorrectionLimitError(
            f"{stop.feature or 'air'}, target {stop.name}: the robot bends by {m_to_mm(size[worst]):.2f} mm, "
            f"allowed are {m_to_mm(limit):.2f} mm; mill with less depth or feed, or check the robot model",
            feature=stop.feature,
            target=stop.name,
            found=float(size[worst]),
            allowed=limit,
        )
    worst = int(residual.argmax())
    if residual[worst] > UNSETTLED:
        stop = route.stops[worst]
        raise CorrectionSettleError(
            f"{stop.feature or 'air'}, target {stop.name}: the correction stays "
            f"{m_to_mm(residual[worst]):.3f} mm off, allowed are "
            f"{m_to_mm(UNSETTLED):.3f} mm; the robot model jumps there, check its play",
            feature=stop.feature,
            target=stop.name,
            found=float(residual[worst]),
            allowed=UNSETTLED,
        )
