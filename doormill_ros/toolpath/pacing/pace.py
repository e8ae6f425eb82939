"""Feeds and corners that a controller can follow: no motion too short in time, no bend too tight for its speed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.curves.arcs import turn_between, turns_between
from doormill_ros.toolpath.curves.curve import Arc
from doormill_ros.toolpath.curves.motion_ways import motion_ways, tool_at_points
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.units import deg_to_rad

ZONES = {"z0": 0.3e-3, "z1": 1.0e-3}  #: radius of the controller's predefined zones [m]
SMALLEST_MILL = 2.5e-3  #: of a smaller mill's radius a corner cut off by z1 could leave wood standing [m]
EASY = deg_to_rad(5.0)  #: a corner up to this is passed at the feed
REVERSAL = deg_to_rad(165.0)  #: beyond it the tool has to stop
LEVEL = 1e-6  #: sine of a slope that is none
SLOWEST = 0.005  #: below this a corner is a stop anyway [m/s]
SPARE = 0.98  #: the file rounds targets and speeds


def eased(steps: Sequence[Step], mill_radius: float, settings: PathSettings) -> list[Step]:
    """The steps of a feature, its corners in the wood flown by, no corner and no bend too tight for its speed.

    A full stop leaves a burn mark. Corners of the finished wall keep theirs: a fly-by would leave wood in them.

    Args:
        steps: From in front of the feature and back.
        mill_radius: Of the tool [m].
        settings: Acceleration, and the shortest time of a motion.
    """
    steps = [step.changed(speed=_speed_on(step, settings)) for step in steps]
    zone = zone_of(mill_radius)
    begin, end = [math.inf] * len(steps), [math.inf] * len(steps)
    for i, (a, b) in enumerate(itertools.pairwise(steps)):
        if not (a.cutting or b.cutting):
            continue
        turn = turn_between(a.curve.tangent(1.0), b.curve.tangent(0.0))
        if turn < EASY or (a.wall and b.wall and a.zone == "fine"):
            continue
        legs = min(ZONES[zone], 0.5 * a.curve.length, 0.5 * b.curve.length)
        speed = math.sqrt(SPARE * settings.cycle.acceleration * corner_radius(turn, legs))
        if turn > REVERSAL or speed < SLOWEST or _plunges(a, b):
            steps[i] = a.changed(zone="fine")
            continue
        steps[i] = a.changed(zone=zone)
        end[i] = begin[i + 1] = speed
    return [
        part
        for step, b, e in zip(steps, begin, end, strict=True)
        for part in _slower(step, b, e, zone, settings)
    ]


def zone_of(mill_radius: float) -> str:
    """The zone with which a mill of that radius [m] flies by its corners in the wood; one of `ZONES`."""
    return "z1" if mill_radius >= SMALLEST_MILL else "z0"


def paced(program: MillingProgram, robot: Robot, settings: PathSettings) -> MillingProgram:
    """The program with every feed lowered to what can be followed along its corrected targets."""
    places = np.array([t.T_base_tool_corrected[:3, 3] for t in program.targets])
    ways = motion_ways(program, places, tool_at_points(program, robot))
    known, length = ways.known.tolist(), ways.length.tolist()
    shortest, acceleration = settings.correction.segment_time, SPARE * settings.cycle.acceleration
    speed = np.array([motion.speed for motion in program.motions])
    followed = np.minimum(SPARE * ways.length / shortest, np.sqrt(acceleration * ways.radius))
    speed = np.where(ways.known, np.minimum(speed, followed), speed).tolist()
    turns = turns_between(ways.end[:-1], ways.begin[1:]).tolist()
    for i, (motion, after) in enumerate(itertools.pairwise(program.motions)):
        if motion.zone == "fine" or not (motion.cutting or after.cutting) or not (known[i] and known[i + 1]):
            continue
        legs = min(ZONES[motion.zone], 0.5 * length[i], 0.5 * length[i + 1])
        passed = math.sqrt(acceleration * corner_radius(turns[i], legs))
        speed[i], speed[i + 1] = min(speed[i], passed), min(speed[i + 1], passed)
    motions = (replace(m, speed=v) if v < m.speed else m for m, v in zip(program.motions, speed, strict=True))
    return replace(program, motions=tuple(motions))


def corner_radius(turn: float, legs: float) -> float:
    """Smallest radius of the parabola on which a corner is flown by [m].

    Args:
        turn: Angle between the directions before and after [rad].
        legs: How far before and after the corner the parabola begins and ends [m].
    """
    # A quadratic Bezier curve over legs of one length is bent most in its middle, by sin(t/2) / (legs cos(t/2)^2).
    sine = math.sin(0.5 * turn)
    return math.inf if sine < 1e-9 else legs * math.cos(0.5 * turn) ** 2 / sine


def _plunges(a: Step, b: Step) -> bool:
    """Whether the corner out of a ramp, flown by, were a plunge: it turns back, seen along the tool, and on, not up.

    So it is in a groove as wide as its mill, at whose ends the mill stops on flat ways too.
    """
    axis, before, after = a.R_door_tool[:, 2], a.curve.tangent(1.0), b.curve.tangent(0.0)
    down, further = float(before @ axis), float(after @ axis)
    return down > LEVEL and further > -LEVEL and float(before @ after) - down * further < -LEVEL


def _speed_on(step: Step, settings: PathSettings) -> float:
    """The feed, or what the bend and the length of a step allow [m/s]."""
    if step.curve.length == 0.0:
        return step.speed  # it only says where the feature begins
    bend = step.curve.radius if isinstance(step.curve, Arc) else math.inf
    quick = step.curve.length / settings.correction.segment_time
    return min(step.speed, SPARE * quick, math.sqrt(SPARE * settings.cycle.acceleration * bend))


def _slower(step: Step, begin: float, end: float, zone: str, settings: PathSettings) -> list[Step]:
    """A step in parts, the first and the last of them no faster than given [m/s]."""
    length, shortest = step.curve.length, settings.correction.segment_time / SPARE
    ends = [max(2.0 * ZONES[zone], v * shortest) if v < step.speed else 0.0 for v in (begin, end)]
    if not any(ends):
        return [step]
    if isinstance(step.curve, Arc) or sum(ends) + step.speed * shortest > length:
        return [step.changed(speed=min(step.speed, begin, end))]
    first, last = ends[0] / length, 1.0 - ends[1] / length
    parts = [step.part(first, last)]
    if ends[0]:
        parts.insert(0, step.part(0.0, first).changed(speed=begin))
    if ends[1]:
        parts.append(step.part(last, 1.0).changed(speed=end))
    return parts
