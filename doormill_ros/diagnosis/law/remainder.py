"""Laws for a linear remainder: searched at the noise, and once more by what rows tell apart where something is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.characterised import Characterised
from doormill_ros.diagnosis.core.verdict import AT_NOISE
from doormill_ros.diagnosis.law.beside import Beside
from doormill_ros.diagnosis.law.characterise import account
from doormill_ros.diagnosis.law.linear import Established, LinearProblem
from doormill_ros.diagnosis.law.place import place_of
from doormill_ros.diagnosis.law.search import LawSearch

#: Established numbers from which on it is less work to project them out once than to fit them beside every law.
_MANY = 50
#: Autocorrelation that is no more than chance.
_FADED = 0.1


def laws_for(
    problem: LinearProblem,
    base: Established,
    terms: Sequence[Any],
    progress: Callable[[str], None] = lambda line: None,
) -> Characterised[Any] | None:
    """Laws beside what a diagnosis has established; None where nothing can be said.

    Args:
        problem: What is left to explain.
        base: What stays.
        terms: What may join.
        progress: Told of every step.
    """
    theta = np.zeros(base.size)
    for _ in range(2):
        beside = Beside(problem, base) if base.size >= _MANY else None
        search = LawSearch(problem, [base], theta, terms, place_of, progress, spread=True, beside=beside)
        best = search.run()
        if not search.laws(best):
            return None
        left = excess(problem.white(best), problem)
        if left < AT_NOISE:
            break
        # What no law holds errs alike from row to row: by that much less do rows say.
        problem = problem.coarser(left)
    return account(search, best, np.ones(len(problem), dtype=bool))


def excess(held_out: FloatArray, problem: LinearProblem) -> float:
    """By how many standard deviations rows err that count as independent, of what a model leaves of rows left out.

    What is left beside the noise repeats itself from row to row: as many rows count as one as its autocorrelation adds
    up to until it has faded.

    Args:
        held_out: In standard deviations, shape (n, c).
        problem: In whose order the rows are.
    """
    same = np.diff(problem.configuration, append=-1) == 0
    power, count = float(np.mean(held_out**2)), 1.0
    alone = same.copy()
    for lag in range(1, len(held_out) // 4):
        alone = alone[:-1] & same[lag:] if lag > 1 else alone[:-1]
        if not alone.any():
            break
        share = float(np.mean((held_out[:-lag] * held_out[lag:])[alone])) / power
        if share < _FADED:
            break
        count += 2.0 * share
    return float(np.sqrt(power * count))
