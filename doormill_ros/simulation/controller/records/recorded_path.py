"""From what the controller commanded to what the compliant robot did."""

from __future__ import annotations

from itertools import groupby

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.controller.records.process import WrenchOf
from doormill_ros.simulation.controller.records.recording import MotionRecording
from doormill_ros.simulation.truth.last_motion import last_directions
from doormill_ros.simulation.truth.robot import TruthRobot


def build_executed_path(
    recording: MotionRecording, truth: TruthRobot | None, T_flange_tool: FloatArray, wrench_of: WrenchOf
) -> ExecutedPath:
    """Apply the process wrench to every cutting sample and let the robot give way.

    Args:
        recording: Commanded samples.
        truth: The robot as it is; None for a rigid one that is as the controller believes.
        T_flange_tool: The tool, shape (4, 4).
        wrench_of: Wrench on the tool of samples that cut.

    Raises:
        ValueError: The recording is empty.
    """
    if not recording.time:
        raise ValueError("nothing was executed, so there is no path")
    poses, q = np.array(recording.poses), np.array(recording.q)
    wrench = np.zeros((len(q), 6))
    travel = _travel(poses)
    start = 0
    for context, group in groupby(recording.context):
        end = start + sum(1 for _ in group)
        if context.cutting:
            wrench[start:end] = wrench_of(context, poses[start:end], travel[start:end])
        start = end
    actual = poses
    if truth is not None:
        actual = truth.deflected(q, wrench, T_flange_tool[:3, 3], last_directions(q)) @ T_flange_tool
    longer = np.array([s.tool_longer for s in recording.surroundings])
    if longer.any():
        actual, poses = _further(actual, longer), _further(poses, longer)
    return ExecutedPath(
        time=np.array(recording.time),
        T_base_tool=actual,
        T_base_tool_commanded=poses,
        q=q,
        motion=np.array([c.index for c in recording.context]),
        cutting=np.array([c.cutting for c in recording.context]),
        feature=np.array([c.feature for c in recording.context], dtype=str),
        wrench=wrench,
        spindle_on=np.array([s.spindle_on for s in recording.surroundings]),
        at_speed=np.array([s.at_speed for s in recording.surroundings]),
        guard_closed=np.array([s.guard_closed for s in recording.surroundings]),
        driven=np.array(recording.driven),
        tool=np.array([s.tool for s in recording.surroundings], dtype=str),
    )


def _further(poses: FloatArray, longer: FloatArray) -> FloatArray:
    """Poses (n, 4, 4) of tips that stand out further by (n,) [m]."""
    moved = poses.copy()
    moved[:, :3, 3] += longer[:, None] * poses[:, :3, 2]
    return moved


def _travel(poses: FloatArray) -> FloatArray:
    """Unit direction in which the tool travels at each sample, zero where it stands; shape (n, 3)."""
    if len(poses) < 2:
        return np.zeros((len(poses), 3))
    steps = np.diff(poses[:, :3, 3], axis=0)
    steps = np.concatenate([steps, steps[-1:]])
    length = np.linalg.norm(steps, axis=1, keepdims=True)
    direction: FloatArray = np.divide(steps, length, out=np.zeros_like(steps), where=length > 1e-12)
    return direction
