"""Where a program sends the robot, sample by sample: for runs of which nobody recorded what the controller did."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.correction.compensate import compensate
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.curves.arcs import STRAIGHT, circles
from doormill_ros.toolpath.curves.curve import Arc, Curve, Line, arc_through
from doormill_ros.toolpath.program import AT_POINTS, MillingProgram, Motion, MotionKind, Target

STEP = 5e-4  #: of the tool between two samples in the wood, at most [m]
SAG = 2e-6  #: by which an arc leaves the chords between its samples there, at most [m]
IN_AIR = 8  #: parts of a line or an arc outside of it: which way the joints turn is all that counts there
EXACT = 1e-8  #: how closely joint angles reach a sample, translation [m] and rotation at 1 m


@dataclass(frozen=True, eq=False)
class CommandedPath:
    """m samples in the order of time.

    Attributes:
        tool: Poses of the tool in base, shape (m, 4, 4).
        q: Joint angles, shape (m, 6) [rad].
        wrench: On the tool at its centre point, base axes, shape (m, 6) [N, N m]; zero outside of the wood.
        time: At the programmed speeds, ways from point to point of joint space aside, shape (m,) [s].
        cutting: Samples in the wood, shape (m,).
        feature: Name of the feature of each sample, empty between features.
    """

    tool: FloatArray
    q: FloatArray
    wrench: FloatArray
    time: FloatArray
    cutting: BoolArray
    feature: tuple[str, ...]


def commanded_path(
    program: MillingProgram, kinematics: Kinematics, T_flange_tool: FloatArray
) -> CommandedPath:
    """The path on which a controller that passes every target moves the tool: lines, circles, and joints.

    Corners that it may fly by are not cut: they lie outside of finished walls.

    Args:
        program: With at least one motion.
        kinematics: Of the robot.
        T_flange_tool: The tool, shape (4, 4).
    """
    parts = list(_parts(program, kinematics, T_flange_tool))
    tool, q, wrench = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("tool", "q", "wrench")
    )
    lasting = np.concatenate([part.time for part in parts])
    return CommandedPath(
        tool=tool,
        q=compensate(tool, q, np.zeros_like, kinematics, T_flange_tool, EXACT).q,
        wrench=wrench,
        time=np.cumsum(lasting),
        cutting=np.concatenate([part.cutting for part in parts]),
        feature=tuple(name for part in parts for name in part.feature),
    )


def _parts(
    program: MillingProgram, kinematics: Kinematics, T_flange_tool: FloatArray
) -> Iterator[CommandedPath]:
    """Samples of each motion, joint angles to be made exact, times since the sample before."""
    home = program.home if program.home is not None else program.q_after(program.motions[0])
    ends = [home, *(program.q_after(motion) for motion in program.motions)]
    for motion, (q_begin, q_end) in zip(program.motions, pairwise(ends), strict=True):
        if motion.kind in AT_POINTS or motion.kind is MotionKind.JOINT:
            pose = kinematics.forward(q_end[None]) @ T_flange_tool
            yield _of_motion(motion, pose, q_end[None], np.zeros(1), 0.0)
            continue
        begin = (kinematics.forward(q_begin[None]) @ T_flange_tool)[0]
        target = program.targets[motion.target]
        via = program.targets[motion.via] if motion.via is not None else None
        curve = _curve(begin, via, target)
        share = _shares(curve, motion.cutting)
        poses = np.tile(np.eye(4), (len(share), 1, 1))
        turn = Rotation.from_matrix(np.stack([begin[:3, :3], target.T_base_tool_corrected[:3, :3]]))
        poses[:, :3, :3] = Slerp([0.0, 1.0], turn)(share).as_matrix()
        poses[:, :3, 3] = curve.points(share)
        knots = [q_begin, q_end] if via is None else [q_begin, via.q, q_end]
        at = np.linspace(0.0, 1.0, len(knots))
        near = np.stack([np.interp(share, at, column) for column in np.transpose(knots)], axis=1)
        yield _of_motion(motion, poses, near, share, curve.length / max(motion.speed, 1e-9))


def _curve(begin: FloatArray, via: Target | None, target: Target) -> Curve:
    """What the tool follows from a pose, shape (4, 4), to a target."""
    start, end = begin[:3, 3], target.T_base_tool_corrected[:3, 3]
    if via is None:
        return Line(start, end)
    middle = via.T_base_tool_corrected[:3, 3]
    _, radius, _, _ = circles(start[None], middle[None], end[None])
    if not np.isfinite(radius[0]) or np.linalg.norm(end - start) < STRAIGHT:
        return Line(start, end)
    return arc_through(start, middle, end)


def _shares(curve: Curve, cutting: bool) -> FloatArray:
    """Shares of a motion's way at which it is sampled; in the wood at its begin, too, where the load is another one."""
    step = min(STEP, float(np.sqrt(8.0 * SAG * curve.radius))) if isinstance(curve, Arc) else STEP
    count = max(1, int(np.ceil(curve.length / step))) if cutting else IN_AIR
    return np.linspace(0.0, 1.0, count + 1)


def _of_motion(
    motion: Motion, poses: FloatArray, q: FloatArray, share: FloatArray, lasting: float
) -> CommandedPath:
    n = len(share)
    wrench = motion.wrench_at(share) if motion.cutting else np.zeros((n, 6))
    passed = lasting * np.diff(share, prepend=0.0)
    return CommandedPath(poses, q, wrench, passed, np.full(n, motion.cutting), (motion.feature,) * n)
