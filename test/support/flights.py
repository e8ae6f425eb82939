"""Tools that fly where a test wants them, the arm standing still."""

import itertools

import numpy as np

from doormill_ros.frames import transform
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.links import FLANGE

HOME = np.radians([0.0, -40.0, 30.0, 0.0, 10.0, 0.0])


def straight(*corners, step=5e-4):
    """Points through corners, at most `step` apart."""
    parts = []
    for start, end in itertools.pairwise(corners):
        count = max(1, int(np.ceil(np.linalg.norm(np.subtract(end, start)) / step)))
        parts.append(np.linspace(start, end, count + 1)[:-1])
    return np.concatenate([*parts, [corners[-1]]])


def flight(T_base_door, tips, rotation, feature="", motion=0, q=HOME):
    """A tool at tips (n, 3) of the door frame with its axes (3, 3) in the door frame."""
    n = len(tips)
    T = T_base_door @ np.stack([transform(rotation, tip) for tip in tips])
    return ExecutedPath(
        time=0.01 * np.arange(n),
        T_base_tool=T,
        T_base_tool_commanded=T,
        q=np.broadcast_to(q, (n, 6)),
        motion=np.broadcast_to(motion, n),
        cutting=np.full(n, bool(feature)),
        feature=np.full(n, feature),
        wrench=np.zeros((n, 6)),
    )


def joint_flight(cell, q, feature=""):
    """The arm at joint angles (n, 6) with its tool where it belongs."""
    n = len(q)
    T = cell.links.frames(q)[FLANGE] @ cell.T_flange_tool
    return ExecutedPath(
        0.01 * np.arange(n),
        T,
        T,
        q,
        np.zeros(n, int),
        np.zeros(n, bool),
        np.full(n, feature),
        np.zeros((n, 6)),
    )
