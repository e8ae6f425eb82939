"""From a recipe and a door pose to the corrected milling program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import CellLayout
from doormill_ros.correction.load import Bench
from doormill_ros.frames import check_transform
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.configuration import configurations
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.toolpath.adapt import DIRECTION_ROUNDS, adapted, straightened
from doormill_ros.toolpath.arcs import check_arcs, unfollowable
from doormill_ros.toolpath.assemble import Itinerary, decisive, itinerary, shift_along
from doormill_ros.toolpath.door_plan import whole_door
from doormill_ros.toolpath.errors import CorrectionLimitError, CorrectionSettleError
from doormill_ros.toolpath.joint_speed import followable
from doormill_ros.toolpath.operation import Operation
from doormill_ros.toolpath.placement import check_placement
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.toolpath.route import check_size, route
from doormill_ros.toolpath.settings import PathSettings, load_settings
from doormill_ros.toolpath.stations import Stations, directions, stations_of
from doormill_ros.toolpath.tool_change import check_tools
from doormill_ros.units import m_to_mm

_ROUNDING = 1e-9  # rad: joint angles this little below a quarter turn count as on it
UNSETTLED = 5e-5  #: residual that a step in the model may leave on a target [m]


def generate_program(
    recipe: Recipe,
    T_base_door: FloatArray,
    layout: CellLayout,
    robot: Robot,
    model: ComplianceModel,
    *,
    operations: Sequence[Operation] | None = None,
    settings: PathSettings | None = None,
) -> MillingProgram:
    """Nominal path on the displaced door, one robot configuration, correction, checks.

    Args:
        recipe: What to mill.
        T_base_door: Where the door stands, shape (4, 4).
        layout: Tool and fixture of the cell.
        robot: Which robot mills.
        model: How the robot gives way under the process wrench.
        operations: This robot's share of the work, see `split`; None for the whole recipe, with
            the door in the clamp of the layout.
        settings: Values of config/toolpath.yaml; None reads the file.

    Returns:
        Targets and motions. Nominal poses stand on the door's true place, corrected ones where the
        robot has to be sent.

    Raises:
        PathError: The leaf class says what makes the door impossible to mill.
    """
    settings = settings or load_settings()
    T_base_door = check_transform(T_base_door, "T_base_door")
    if operations is None:
        check_placement(T_base_door, recipe, layout)
        operations = whole_door(recipe)
    check_tools(operations, settings.checks)
    bench = Bench(Kinematics(robot), model, layout.T_flange_tool, settings.correction.tolerance)
    plan, path = route(recipe, operations, T_base_door, layout, robot, settings)
    plan = replace(plan, steps=tuple(followable(plan.steps, path, robot, settings.checks)))
    stations, q = stations_of(plan.steps, T_base_door), path.stations
    if not plan.fixed:
        plan, stations, q = adapted(plan, q, T_base_door, bench, settings.correction)
    program = _program(recipe, plan, stations, q, bench, robot, settings)
    flat = unfollowable(program)
    if flat and not plan.fixed:
        # A step in the correction has bent an arc over that was almost a line.
        plan, stations, q = straightened(plan, q, T_base_door, bench, set(flat))
        program = _program(recipe, plan, stations, q, bench, robot, settings)
    if flat:
        check_arcs(program)
    return program


def _program(
    recipe: Recipe,
    plan: Plan,
    stations: Stations,
    q: FloatArray,
    bench: Bench,
    robot: Robot,
    settings: PathSettings,
) -> MillingProgram:
    """Correct every target and write the motions."""
    route = itinerary(plan)
    check_size([stop.feature for stop in route.stops], settings)
    place = np.array([[s.visits[0].step, s.visits[0].station] for s in route.stops])
    loads = [(i, v.step, v.station) for i, s in enumerate(route.stops) for v in decisive(s, plan.steps)]
    owner, step, station = np.array(loads).T
    nominal = stations.T_base_tool[place[:, 0], place[:, 1]]
    at_target, wrench = q[place[:, 0], place[:, 1]], stations.wrench[step]
    turning = directions(q)[step, station]
    for _ in range(DIRECTION_ROUNDS):
        found = bench.corrected_for_all(nominal, at_target, owner, wrench, turning)
        # What counts is how the joints turn on the way that is sent, not on the nominal one.
        sent = q + shift_along(route, found.q - at_target)
        before, turning = turning, directions(sent)[step, station]
        if np.array_equal(before, turning):
            break
    _check_correction(route, found.T_base_tool, nominal, found.residual, settings)
    share = 1.0 / np.bincount(owner)[owner]
    mean_wrench = np.zeros((len(route.stops), 6))
    np.add.at(mean_wrench, owner, wrench * share[:, None])
    conf = configurations(robot, found.q)
    targets = tuple(
        Target(stop.name, *arrays)
        for stop, *arrays in zip(
            route.stops, nominal, found.T_base_tool, found.q, conf, mean_wrench, found.deflection, strict=True
        )
    )
    motions = tuple(
        _motion(s, int(route.end[i]), int(route.via[i]), stations.wrench[i]) for i, s in enumerate(plan.steps)
    )
    return MillingProgram(recipe.door_id, recipe.version, targets, motions)


def _motion(step: Step, end: int, via: int, wrench: FloatArray) -> Motion:
    return Motion(
        kind=step.kind,
        target=end,
        via=via if step.kind is MotionKind.CIRCULAR else None,
        speed=step.speed,
        zone=step.zone,
        feature=step.feature,
        cutting=step.cutting,
        wrench=wrench if step.cutting else np.zeros(6),
        spindle_speed=step.spindle_speed,
    )


def _check_correction(
    route: Itinerary, corrected: FloatArray, nominal: FloatArray, residual: FloatArray, settings: PathSettings
) -> None:
    size = np.linalg.norm((corrected - nominal)[:, :3, 3], axis=1)
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
