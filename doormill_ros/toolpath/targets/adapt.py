"""Divide a plan until the corrected path follows the loaded robot closely enough."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.toolpath.curves.curve import Arc, Line
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import Correction
from doormill_ros.toolpath.stations import FRACTIONS, Stations, directions, stations_of
from doormill_ros.toolpath.targets.refine import Division, bends, divide

DIRECTION_ROUNDS = 3  #: the correction itself may turn a joint that hardly moves
TALLEST_FLAT_ARC = 1e-4  #: arcs up to this height may become two chords, which leave a quarter of it [m]
ROUNDS = 5  #: play in a gear makes steps that no number of divisions would follow


def direction_rounds(loaded: LoadedRobot) -> int:
    """How often a path is corrected at most, each time for the directions in which its joints turn."""
    return DIRECTION_ROUNDS if loaded.remembers else 1


def adapted(
    plan: Plan, q: FloatArray, T_base_door: FloatArray, loaded: LoadedRobot, settings: Correction
) -> tuple[Plan, Stations, FloatArray]:
    """The plan with its cuts divided where the correction asks for it.

    The first round spreads the changes of wrench and divides by the bend it sees; further rounds
    divide what still bends too much, down to the shortest allowed segment. A smooth robot model
    is done after the first or second; play in a gear makes a step where a joint turns back and
    takes all of them.

    Args:
        plan: The plan.
        q: Joint angles at its stations, shape (m, k, 6) [rad].
        T_base_door: Where the door stands, shape (4, 4).
        loaded: Robot, model and tool.
        settings: Limits.

    Returns:
        The divided plan, its stations, and the joint angles there, shape (m', k, 6) [rad].
    """
    k = len(FRACTIONS)
    stations = stations_of(plan.steps, T_base_door)
    shift = np.zeros_like(q)  # from the nominal joint angles to the ones sent
    for number in range(ROUNDS):
        cut = np.array([i for i, step in enumerate(plan.steps) if step.cutting])
        # The first round asks for the ends of steps alone, the directions of joints for all between them, too.
        asked = np.arange(k) if number or loaded.remembers else np.array([0, k - 1])
        every, place = np.repeat(cut, len(asked)), np.tile(asked, len(cut))
        nominal, at = stations.T_base_tool[every, place], q[every, place]
        turning = directions(q + shift)[every, place]
        found = loaded.corrected(nominal, at, stations.loads(every, place, turning))
        for _ in range(direction_rounds(loaded) - 1):
            shift[every, place] = found.q - at
            before, turning = turning, directions(q + shift)[every, place]
            changed = (turning != before).any(axis=1)
            if not changed.any():
                break
            loads = stations.loads(every, place, turning)
            found = loaded.corrected_again(found, nominal, at, np.arange(len(at)), loads, changed)
        shift[every, place] = found.q - at
        correction = np.zeros((len(plan.steps), k, 3))
        correction[every, place] = (found.T_base_tool - nominal)[:, :3, 3]
        bend = np.zeros(len(plan.steps))
        if number:
            arc = np.array([plan.steps[i].curve.is_arc for i in cut])
            bend[cut] = bends(stations.T_base_tool[cut, :, :3, 3] + correction[cut], arc)
        if number and not (bend > settings.bend).any():
            break
        division = divide(plan.steps, correction, bend, settings, blend=number == 0)
        if number and len(division.steps) == len(plan.steps):
            break
        shift = _between(shift, division)
        plan, stations, q = _divided(plan, q, division, T_base_door, loaded)
    return plan, stations, q


def straightened(
    plan: Plan, q: FloatArray, T_base_door: FloatArray, loaded: LoadedRobot, flat: Collection[int]
) -> tuple[Plan, Stations, FloatArray]:
    """The plan with some of its arcs replaced by their two chords, if they are flat enough for that.

    Args:
        plan: The plan.
        q: Joint angles at its stations, shape (m, k, 6) [rad].
        T_base_door: Where the door stands, shape (4, 4).
        loaded: Robot, model and tool.
        flat: Steps to replace.

    Returns:
        As `adapted`.
    """
    parts: list[tuple[int, float, float, Step]] = []
    for i, step in enumerate(plan.steps):
        curve = step.curve
        if i not in flat or not isinstance(curve, Arc) or curve.height > TALLEST_FLAT_ARC:
            parts.append((i, 0.0, 1.0, step))
            continue
        via = curve.point(0.5)
        for first, last, chord in ((0.0, 0.5, Line(curve.start, via)), (0.5, 1.0, Line(via, curve.end))):
            zone = step.zone if last == 1.0 else "z0"
            line = step.changed(kind=MotionKind.LINEAR, curve=chord, zone=zone)
            parts.append((i, first, last, line))
    parent, spans = [part[0] for part in parts], [part[1:3] for part in parts]
    division = Division(tuple(part[3] for part in parts), np.array(parent), np.array(spans))
    return _divided(plan, q, division, T_base_door, loaded)


def _divided(
    plan: Plan, q: FloatArray, division: Division, T_base_door: FloatArray, loaded: LoadedRobot
) -> tuple[Plan, Stations, FloatArray]:
    new = [
        part.curve is not plan.steps[i].curve for part, i in zip(division.steps, division.parent, strict=True)
    ]
    plan = replace(plan, steps=division.steps)
    stations = stations_of(plan.steps, T_base_door)
    q = _between(q, division)
    # At the stations of a step that stays whole the postures are known.
    nominal, near = stations.T_base_tool[new].reshape(-1, 4, 4), q[new].reshape(-1, 6)
    q[new] = loaded.posture(nominal, near).reshape(-1, *q.shape[1:])
    return plan, stations, q


def _between(q: FloatArray, division: Division) -> FloatArray:
    """Joint angles of the parts, interpolated between the stations of their parents."""
    k = len(FRACTIONS)
    t = division.span[:, :1] + FRACTIONS * (division.span[:, 1:] - division.span[:, :1])  # (m, k)
    below = np.minimum((t * (k - 1)).astype(int), k - 2)
    share = (t * (k - 1) - below)[..., None]
    known, rows = q[division.parent], np.arange(len(t))[:, None]
    between: FloatArray = (1.0 - share) * known[rows, below] + share * known[rows, below + 1]
    return between
