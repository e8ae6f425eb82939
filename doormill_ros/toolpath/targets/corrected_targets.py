"""The targets of a program, each corrected for what bends the robot there."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.robot.configuration import configurations
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.errors import CorrectionLimitError, CorrectionSettleError
from doormill_ros.toolpath.plan import Plan
from doormill_ros.toolpath.program import Target
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.toolpath.stations import Stations, directions
from doormill_ros.toolpath.targets.adapt import direction_rounds
from doormill_ros.toolpath.targets.doubt import check_expected, expected_errors
from doormill_ros.toolpath.targets.itinerary import Itinerary, decisive, shift_along
from doormill_ros.units import m_to_mm

UNSETTLED = 5e-5  #: residual that a step in the model may leave on a target [m]


def corrected_targets(
    plan: Plan,
    route: Itinerary,
    stations: Stations,
    q: FloatArray,
    loaded: LoadedRobot,
    robot: Robot,
    settings: PathSettings,
) -> tuple[Target, ...]:
    """Correct every target.

    Args:
        plan: Steps, divided as the correction asks for.
        route: Targets and steps.
        stations: Nominal poses and wrenches along the steps.
        q: Joint angles at the stations, shape (m, k, 6) [rad].
        loaded: Robot, model and tool.
        robot: The same robot, for its configurations.
        settings: Limits of the correction.

    Raises:
        CorrectionLimitError: A target would be corrected further than allowed.
        CorrectionSettleError: A target cannot be corrected.
        ExpectedErrorError: What springs and forces leave to chance is more than the tolerance.
    """
    place = np.array([[s.visits[0].step, s.visits[0].station] for s in route.stops])
    used = [(i, v.step, v.station) for i, s in enumerate(route.stops) for v in decisive(s, plan.steps)]
    owner, step, station = np.array(used).T
    nominal = stations.T_base_tool[place[:, 0], place[:, 1]]
    at_target = q[place[:, 0], place[:, 1]]
    loads = stations.loads(step, station, directions(q)[step, station])
    found = loaded.corrected_for_all(nominal, at_target, owner, loads)
    for _ in range(direction_rounds(loaded) - 1):
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
    return tuple(
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
