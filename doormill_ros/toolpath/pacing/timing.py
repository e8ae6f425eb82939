"""How long a program takes on the controller."""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.curves.motion_ways import motion_ways, tool_at_points
from doormill_ros.toolpath.program import AT_POINTS, RACK_KINDS, MillingProgram, Motion, MotionKind
from doormill_ros.toolpath.settings import Cycle

HOME_SPEED = 0.5  #: v500 of MoveHome in rapid/DoorCell.mod [m/s]
WAY_SAMPLES = 21  #: places at which the tool's way on a joint motion is looked at
JOINT_MOTIONS = (MotionKind.JOINT, *AT_POINTS)


def motion_times(program: MillingProgram, robot: Robot, cycle: Cycle) -> FloatArray:
    """Time of every motion from home on, and last of all that of the way home, shape (n + 1,) [s].

    The tool speeds up and slows down with the acceleration along its path, between speeds that it has where one
    motion follows another: 0 at a stop, else the lower of the two. A MoveJ or MoveAbsJ takes its slowest joint's time
    likewise, no less than the tool's way at its speed. Each stop takes its time, and each change of the spindle speed
    before a motion. A program that knows no home takes no time for the ways from and to it.

    Args:
        program: The program.
        robot: Joint speeds.
        cycle: Accelerations, and how long stops and changes of spindle speed take.
    """
    n = len(program.motions)
    if not n:
        return np.zeros(1)
    times = [0.0] * (n + 1)
    motions = program.motions
    stop = [_stops(program, i) for i in range(n)]
    ways = motion_lengths(program, robot).tolist()
    lengths = {i: ways[i] for i in range(1, n) if motions[i].kind not in JOINT_MOTIONS}
    passed = _passed(program, lengths, stop, cycle.acceleration)
    joint = {i for i, motion in enumerate(motions) if motion.kind in JOINT_MOTIONS} | {n}
    by_joints = _joint_times(program, robot, cycle, joint)
    spindle = 0.0
    for i, motion in enumerate(motions):
        if i in lengths:
            times[i] = _stretch(lengths[i], motion.speed, cycle.acceleration, passed[i], passed[i + 1])
        elif i in joint:
            times[i] = by_joints[i]
        times[i] += cycle.stop if stop[i] else 0.0
        if motion.kind in RACK_KINDS:
            times[i] += cycle.measuring if motion.kind is MotionKind.MEASURE else cycle.changing
        if motion.spindle_speed not in (0.0, spindle):
            times[i] += cycle.spindle
        spindle = motion.spindle_speed
    times[-1] = by_joints[n]
    return np.array(times)


def reading_time(program: MillingProgram, cycle: Cycle) -> float:
    """How long the controller reads and checks the target file [s]."""
    return cycle.reading * (len(program.targets) + len(program.motions) + len(program.points))


def program_time(program: MillingProgram, times: FloatArray, cycle: Cycle) -> float:
    """The program from home to home, and reading it [s]; arguments as of `feature_times`."""
    return float(times.sum()) + reading_time(program, cycle)


def feature_times(program: MillingProgram, times: FloatArray) -> dict[str, float]:
    """Time of each feature with the way to it from the one before [s], in the order of milling.

    The start from home, with the spindle's, and the way home are of the whole door, as in appendix A.1 of the thesis.

    Args:
        program: The program.
        times: Time of every motion and of the way home, shape (n + 1,) [s].
    """
    result: dict[str, float] = {}
    waiting = -math.inf
    for motion, time in zip(program.motions, times[:-1], strict=True):
        waiting += float(time)
        if motion.feature:
            result[motion.feature] = result.get(motion.feature, 0.0) + max(
                waiting, float(time) if result else 0.0
            )
            waiting = 0.0
    return result


def _joint_times(
    program: MillingProgram, robot: Robot, cycle: Cycle, motions: Collection[int]
) -> dict[int, float]:
    """Time of joint motions from rest to rest by their numbers [s], that of the way home among them.

    0 where an end is not known.
    """
    n = len(program.motions)
    times = dict.fromkeys(motions, 0.0)
    known = [i for i in sorted(motions) if program.home is not None or i not in (0, n)]
    stands = [program.home, *(program.q_after(motion) for motion in program.motions), program.home]
    if not known:
        return times
    start, end = (np.array([stands[i + k] for i in known], dtype=float) for k in (0, 1))
    ways = _ways(program, robot, start, end)
    for i, move, way in zip(known, np.abs(end - start).tolist(), ways.tolist(), strict=True):
        slowest = max(
            _stretch(turn, most, most / cycle.joint_ramp, 0.0, 0.0)
            for turn, most in zip(move, robot.max_velocity.tolist(), strict=True)
        )
        speed = program.motions[i].speed if i < n else HOME_SPEED
        times[i] = max(slowest, _stretch(way, speed, cycle.acceleration, 0.0, 0.0))
    return times


def _ways(program: MillingProgram, robot: Robot, start: FloatArray, end: FloatArray) -> FloatArray:
    """Lengths of the tool's ways on joint motions between postures, shapes (m, 6) [rad] -> (m,) [m]."""
    if not program.targets:
        return np.zeros(len(start))
    first, kinematics = program.targets[0], Kinematics(robot)
    T_flange_tool = inverse(kinematics.forward(first.q)) @ first.T_base_tool_corrected
    share = np.linspace(0.0, 1.0, WAY_SAMPLES)[:, None]
    q = start[:, None] + share * (end - start)[:, None]  # (m, samples, 6)
    places = (kinematics.forward(q) @ T_flange_tool)[..., :3, 3]
    lengths: FloatArray = np.linalg.norm(np.diff(places, axis=1), axis=2).sum(axis=1)
    return lengths


def _stops(program: MillingProgram, index: int) -> bool:
    """Whether the robot comes to rest behind a motion: programmed, or because RAPID has to know where it is."""
    if index + 1 == len(program.motions):
        return True
    motion, after = program.motions[index], program.motions[index + 1]
    if motion.zone == "fine" or motion.spindle_speed != after.spindle_speed:
        return True
    return _is_way(motion) or _is_way(after) or motion.feature != after.feature


def _is_way(motion: Motion) -> bool:
    return not motion.feature or motion.kind in JOINT_MOTIONS


def _passed(
    program: MillingProgram, lengths: dict[int, float], stop: list[bool], acceleration: float
) -> list[float]:
    """Speed at the beginning of every motion and at the end of the last one, n + 1 of them [m/s]."""
    n = len(program.motions)
    passed = [0.0] * (n + 1)
    for i in range(1, n):
        if not stop[i - 1] and i in lengths and i - 1 in lengths:
            passed[i] = min(program.motions[i - 1].speed, program.motions[i].speed)
    for i in range(n):
        reached = math.sqrt(passed[i] ** 2 + 2.0 * acceleration * lengths.get(i, 0.0))
        passed[i + 1] = min(passed[i + 1], reached)
    for i in reversed(range(n)):
        passed[i] = min(passed[i], math.sqrt(passed[i + 1] ** 2 + 2.0 * acceleration * lengths.get(i, 0.0)))
    return passed


def _stretch(length: float, speed: float, acceleration: float, begin: float, end: float) -> float:
    """Time of a way that is entered and left at given speeds, no higher than that on it."""
    if length <= 0.0:
        return 0.0
    highest = math.sqrt(acceleration * length + 0.5 * (begin**2 + end**2))
    if highest <= speed:
        return (2.0 * highest - begin - end) / acceleration
    ramps = (2.0 * speed**2 - begin**2 - end**2) / (2.0 * acceleration)
    return (2.0 * speed - begin - end) / acceleration + (length - ramps) / speed


def motion_lengths(program: MillingProgram, robot: Robot | None = None) -> FloatArray:
    """Lengths of the MoveL and MoveC of n motions on the nominal path, 0 for the others, shape (n,) [m].

    Without a robot, 0 for one that begins at a point of joint space, too.
    """
    places = np.array([target.T_base_tool_nominal[:3, 3] for target in program.targets]).reshape(-1, 3)
    points = tool_at_points(program, robot) if robot is not None and program.targets else None
    return motion_ways(program, places, points).length
