"""Runs from which on something may have changed: proposed by a quick look, to be judged by the search."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.core.fitting.gain import gain_of
from doormill_ros.diagnosis.core.fitting.price import price_of_number
from doormill_ros.diagnosis.core.searching.beam import ENTRY
from doormill_ros.diagnosis.runs.limits import FEWEST
from doormill_ros.diagnosis.runs.problem import RunProblem

MOST = 4  #: steps that are proposed
_ENDS = 3  #: runs before a step and from it on, at least
_STRAYS = 6.0  #: standard deviations beyond which a figure pulls no more


def possible_steps(problem: RunProblem) -> tuple[int, ...]:
    """Numbers of runs from which on something may have changed: the best gain joins, then the next one beside it."""
    count = len(problem.doors)
    if count < FEWEST:
        return ()
    times = [run.time for run in problem.doors]
    columns = [
        (times.index(change.course.at) if change.course.steps else 0, problem.columns(change))
        for change in problem.changed_at(tuple(range(_ENDS, count - _ENDS + 1))).candidates()
    ]
    left = np.clip(problem.predict((), np.zeros(0)).white[:, 0], -_STRAYS, _STRAYS)
    each = price_of_number(len(problem))
    found: list[int] = []
    for _ in range(MOST):
        gains = [gain_of(block, left) - each * block.shape[1] for _, block in columns]
        best = int(np.argmax(gains))
        if gains[best] < ENTRY:
            break
        step, block = columns[best]
        if step > 0 and step not in found:
            found.append(step)
        basis, size, _ = np.linalg.svd(block, full_matrices=False)
        basis = basis[:, size > 1e-9 * size[0]]
        left = left - basis @ (basis.T @ left)
        columns = [(number, other - basis @ (basis.T @ other)) for number, other in columns]
    return tuple(sorted(found))
