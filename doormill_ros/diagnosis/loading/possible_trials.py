"""Trials that could be measured next: postures, loads, approaches and reflectors, none of them measured yet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.trials import Reflector, Trials
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.statistics import uniform

_POSTURES = 24  #: postures that are considered
#: Loads considered, base axes.
_LOADS = np.vstack([np.eye(3), -np.eye(3)])
#: Where a reflector could be added: at the edge of the foot, or a hand's breadth off a link's frame [m].
_NEW_BASE, _NEW = np.array([0.5, 0.4, 0.1]), np.array([0.15, 0.1, 0.1])
LOAD_NAMES = ("+x", "+y", "+z", "-x", "-y", "-z")


def possible_trials(data: Trials, seed: int) -> tuple[Trials, FloatArray]:
    """Postures about the tested ones, six loads, two approaches, all reflectors; the load of each, shape (n,).

    A joint is turned within its tested range, or half a radian about the middle of a smaller one.
    """
    low, high = data.q.min(axis=0), data.q.max(axis=0)
    middle, half = (low + high) / 2.0, np.maximum((high - low) / 2.0, 0.5)
    _, first = np.unique(data.configuration, return_index=True)
    postures = np.vstack([data.q[first][:8], middle + half * (2.0 * uniform((_POSTURES, 6), seed) - 1.0)])[
        :_POSTURES
    ]
    reflectors = dict(data.reflectors)
    carried = {reflector.link for reflector in reflectors.values()}
    for link in range(7):
        if link not in carried:
            reflectors[f"new on link {link}"] = Reflector(link, _NEW_BASE if link == 0 else _NEW)
    grid = np.array(
        [
            (posture, load, approach, reflector)
            for posture in range(len(postures))
            for load in range(6)
            for approach in (-1, 1)
            for reflector in range(len(reflectors))
        ]
    )
    q = postures[grid[:, 0]]
    force = float(np.median(np.linalg.norm(data.wrench[:, :3], axis=1)))
    axes = Kinematics(data.dh).forward(q)[:, :3, :3]
    angle = data.wrench_frame_rotation
    c, s = np.cos(angle), np.sin(angle)
    to_sensor = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    wrench = np.zeros((len(grid), 6))
    wrench[:, :3] = np.einsum("ij,nkj,nk->ni", to_sensor, axes.transpose(0, 2, 1), force * _LOADS[grid[:, 1]])
    names = np.array(list(reflectors))
    n = len(grid)
    return Trials(
        robot=data.robot,
        dh=data.dh,
        joint_stiffness=data.joint_stiffness,
        noise=data.noise,
        wrench_frame_rotation=data.wrench_frame_rotation,
        load_point=data.load_point,
        reflectors=reflectors,
        trial=np.arange(1, n + 1),
        time=np.full(n, float(np.median(data.time))),
        dt=np.full(n, float(np.median(data.dt))),
        temperature=np.full(n, np.nan),
        q=q,
        direction=np.repeat(grid[:, 2:3].astype(float), 6, axis=1),
        wrench=wrench,
        reflector=names[grid[:, 3]],
        displacement=np.zeros((n, 3)),
    ), grid[:, 1]


def chosen_of(pool: Trials, rows: list[int]) -> Trials:
    """Some of them, by their indices."""
    index = np.array(rows, dtype=int)
    per_trial = (
        "trial",
        "time",
        "dt",
        "temperature",
        "q",
        "direction",
        "wrench",
        "reflector",
        "displacement",
    )
    return replace(pool, **{name: getattr(pool, name)[index] for name in per_trial})
