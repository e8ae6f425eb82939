"""Laws for a linear remainder: searched at the noise, and once more by what rows tell apart where something is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.characterised import Characterised
from doormill_ros.diagnosis.core.verdict import AT_NOISE
from doormill_ros.diagnosis.law.characterise import account
from doormill_ros.diagnosis.law.linear import Established, LinearProblem, excess
from doormill_ros.diagnosis.law.place import place_of
from doormill_ros.diagnosis.law.search import LawSearch


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
        search = LawSearch(problem, [base], theta, terms, place_of, progress, spread=True)
        best = search.run()
        if not search.laws(best):
            return None
        left = excess(problem.white(best), problem)
        if left < AT_NOISE:
            break
        # What no law holds errs alike from row to row: by that much less do rows say.
        problem = problem.coarser(left)
    return account(search, best, np.ones(len(problem), dtype=bool))
