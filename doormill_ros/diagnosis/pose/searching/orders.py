"""Finds which high orders of a joint's own angle the residual still holds."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.ranking import ranks
from doormill_ros.diagnosis.pose.fitting.fit import Fitted
from doormill_ros.robot_model.pose.chain import derivatives, joint_turn

#: Highest order that is looked for: twice the input turns of a 1:100 gear and the second wave of that.
HIGHEST = 420
#: Orders that are taken up for one joint at most.
MOST = 60
#: How far an order's score has to stand above the common run of scores.
FACTOR = 6.0
_CHUNK = 2000


def order_scores(fitted: Fitted, joint: int, orders: IntArray) -> FloatArray:
    """Fall of the sum of squares when an order alone is added to a fit, shape (len(orders),)."""
    problem = fitted.problem
    top, bottom = np.zeros(len(orders), dtype=complex), 0.0
    for series, data in enumerate(problem.sets):
        scale = problem.scale(series)
        error = problem.residual(series) * scale
        turn = derivatives(problem.frames(series), problem.placements[series])[:, joint_turn(joint)] * scale
        weight = problem.weights[series]
        along = weight * np.sum(turn * error, axis=1)
        bottom += float(np.sum(weight * np.sum(turn**2, axis=1)))
        for start in range(0, len(data), _CHUNK):
            part = slice(start, start + _CHUNK)
            # Powers of one phase: a tenth of the time of an exponential for every order.
            phase = np.exp(1j * np.outer(data.q[part, joint - 1], orders))
            top += along[part] @ phase
    return 2.0 * np.abs(top) ** 2 / max(bottom, 1e-12)


def find_orders(fitted: Fitted, joint: int, known: int) -> tuple[int, ...]:
    """Orders above `known` that stand out, ascending."""
    orders = np.arange(known + 1, HIGHEST + 1)
    scores = order_scores(fitted, joint, orders)
    limit = max(FACTOR * float(np.median(scores)), 25.0)
    best = ranks(-scores)[:MOST]
    return tuple(sorted(int(orders[i]) for i in best if scores[i] > limit))
