"""How long a program takes."""

from __future__ import annotations

import math

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.program import MillingProgram, MotionKind
from doormill_ros.toolpath.settings import Cycle


def motion_times(program: MillingProgram, robot: Robot, cycle: Cycle) -> FloatArray:
    """Time of every motion, shape (n,) [s].

    The tool runs at its programmed speed and loses v / a at every full stop, half of it to each
    of the motions beside it; a way too short for its speed takes 2 sqrt(l / a). A MoveJ takes its
    slowest joint's time likewise. The way from home to the first target is left out: it depends
    on the controller's program.

    Args:
        program: The program.
        robot: Joint speeds.
        cycle: Accelerations.
    """
    times = np.zeros(len(program.motions))
    stopped = True
    for i, motion in enumerate(program.motions):
        stops = motion.zone == "fine"
        if i:
            before = program.motions[i - 1].target
            if motion.kind is MotionKind.JOINT:
                move = np.abs(program.targets[motion.target].q - program.targets[before].q)
                slow = move / robot.max_velocity
                joint = int(slow.argmax())
                times[i] = _stretch(move[joint], robot.max_velocity[joint], cycle.joint_acceleration, 2)
            else:
                ends = stopped + stops
                times[i] = _stretch(_length(program, i), motion.speed, cycle.acceleration, ends)
        stopped = stops or motion.kind is MotionKind.JOINT
    return times


def feature_times(program: MillingProgram, times: FloatArray) -> dict[str, float]:
    """Time of each feature, the way to it included [s], in the order of milling.

    Args:
        program: The program.
        times: Time of every motion, shape (n,) [s].
    """
    result: dict[str, float] = {}
    waiting = 0.0
    for motion, time in zip(program.motions, times, strict=True):
        waiting += float(time)
        if motion.feature:
            result[motion.feature] = result.get(motion.feature, 0.0) + waiting
            waiting = 0.0
    return result


def _stretch(length: float, speed: float, acceleration: float, ends: int) -> float:
    """Time of a way with this many of its two ends at rest."""
    if length <= 0.0:
        return 0.0
    if ends == 2 and length < speed**2 / acceleration:
        return 2.0 * math.sqrt(length / acceleration)
    return length / speed + 0.5 * ends * speed / acceleration


def _length(program: MillingProgram, index: int) -> float:
    """Length of a MoveL or MoveC on the nominal path [m]."""
    motion = program.motions[index]
    start = program.targets[program.motions[index - 1].target].T_base_tool_nominal[:3, 3]
    end = program.targets[motion.target].T_base_tool_nominal[:3, 3]
    if motion.via is None:
        return math.dist(start, end)
    via = program.targets[motion.via].T_base_tool_nominal[:3, 3]
    a, b = math.dist(start, via), math.dist(via, end)
    # Law of cosines at the circle point gives half the arc that lies opposite.
    cosine = (a * a + b * b - math.dist(start, end) ** 2) / (2.0 * a * b)
    corner = math.acos(min(1.0, max(-1.0, cosine)))
    if math.pi - corner < 1e-6:
        return a + b
    return (math.pi - corner) * math.dist(start, end) / math.sin(corner)
