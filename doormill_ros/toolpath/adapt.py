"""Divide a plan until the corrected path follows the loaded robot closely enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from doormill_ros.correction.load import Bench
from doormill_ros.toolpath.plan import Plan
from doormill_ros.toolpath.refine import Division, divide
from doormill_ros.toolpath.settings import Correction
from doormill_ros.toolpath.stations import FRACTIONS, Stations, directions, stations_of

ROUNDS = 5  #: play in a gear makes steps that no number of divisions would follow


def adapted(
    plan: Plan, q: np.ndarray, T_base_door: np.ndarray, bench: Bench, settings: Correction
) -> tuple[Plan, Stations, np.ndarray]:
    """The plan with its cuts divided where the correction asks for it.

    The first round spreads the changes of wrench and divides by the bend it sees; further rounds
    divide what still bends too much, down to the shortest allowed segment. A smooth robot model
    is done after the first or second; play in a gear makes a step where a joint turns back and
    takes all of them.

    Args:
        plan: The plan.
        q: Joint angles at its stations, shape (m, k, 6) [rad].
        T_base_door: Where the door stands, shape (4, 4).
        bench: Robot, model and tool.
        settings: Limits.

    Returns:
        The divided plan, its stations, and the joint angles there, shape (m', k, 6) [rad].
    """
    k = len(FRACTIONS)
    stations = stations_of(plan.steps, T_base_door)
    for number in range(ROUNDS):
        cut = np.array([i for i, step in enumerate(plan.steps) if step.cutting])
        load = np.repeat(stations.wrench[cut], k, axis=0)
        nominal = stations.T_base_tool[cut].reshape(-1, 4, 4)
        turning = directions(q)[cut].reshape(-1, 6)
        found = bench.corrected(nominal, q[cut].reshape(-1, 6), load, turning)
        correction = np.zeros((len(plan.steps), k, 3))
        correction[cut] = (found.T_base_tool - nominal)[:, :3, 3].reshape(-1, k, 3)
        division = divide(plan.steps, correction, settings, blend=number == 0)
        if len(division.steps) == len(plan.steps):
            break
        plan = replace(plan, steps=division.steps)
        stations = stations_of(plan.steps, T_base_door)
        q = _between(q, division)
        q = bench.posture(stations.T_base_tool.reshape(-1, 4, 4), q.reshape(-1, 6)).reshape(q.shape)
    return plan, stations, q


def _between(q: np.ndarray, division: Division) -> np.ndarray:
    """Joint angles of the parts, interpolated between the stations of their parents."""
    k = len(FRACTIONS)
    t = division.span[:, :1] + FRACTIONS * (division.span[:, 1:] - division.span[:, :1])  # (m, k)
    below = np.minimum((t * (k - 1)).astype(int), k - 2)
    share = (t * (k - 1) - below)[..., None]
    known, rows = q[division.parent], np.arange(len(t))[:, None]
    return (1.0 - share) * known[rows, below] + share * known[rows, below + 1]
