"""Finds which high orders of a joint's own angle the residual still holds."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.ranking import ranks
from doormill_ros.diagnosis.pose.fit import Fitted
from doormill_ros.robot_model.pose.chain import derivatives, joint_turn

#: Highest order that is looked for: the 24th wave and a little more of the input turns of a 1:100 gear.
HIGHEST = 2600
#: Orders that are taken up for one joint at most.
MOST = 60
#: How far an order's score has to stand above the common run of scores, and how high at least: noise alone brings one
#: of the orders of a joint above that once in a thousand times.
FACTOR, LEAST = 6.0, 30.0
#: Parts of a turn that angles are sorted into: the phase of the highest order is off by 0.03 rad at most.
_PARTS = 2**18


def order_scores(fitted: Fitted, joint: int) -> FloatArray:
    """Fall of the sum of squares when an order alone is added to a fit, by order from 0 on, shape (HIGHEST + 1,)."""
    problem = fitted.problem
    pull, bottom = np.zeros(_PARTS), 0.0
    for series, data in enumerate(problem.sets):
        scale = problem.scale(series)
        error = problem.residual(series) * scale
        turn = derivatives(problem.frames(series), problem.placements[series])[:, joint_turn(joint)] * scale
        weight = problem.weights[series]
        part = np.rint(data.q[:, joint - 1] * (_PARTS / (2.0 * np.pi))).astype(int) % _PARTS
        pull += np.bincount(part, weight * np.sum(turn * error, axis=1), _PARTS)
        bottom += float(np.sum(weight * np.sum(turn**2, axis=1)))
    # All orders of the pulls by angle at once.
    top = np.fft.rfft(pull)[: HIGHEST + 1]
    return 2.0 * np.abs(top) ** 2 / max(bottom, 1e-12)


def find_orders(fitted: Fitted, joint: int, known: int) -> tuple[int, ...]:
    """Orders above `known` that stand out, ascending."""
    scores = order_scores(fitted, joint)[known + 1 :]
    limit = max(FACTOR * float(np.median(scores)), LEAST)
    best = ranks(-scores)[:MOST]
    return tuple(sorted(known + 1 + int(i) for i in best if scores[i] > limit))
