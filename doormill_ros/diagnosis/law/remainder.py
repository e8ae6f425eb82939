"""Laws for a linear remainder: searched at the noise, and once more by what rows tell apart where something is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.core.words.verdict import AT_NOISE
from doormill_ros.diagnosis.law.beside import Beside
from doormill_ros.diagnosis.law.characterise import account
from doormill_ros.diagnosis.law.linear import Established, LinearProblem
from doormill_ros.diagnosis.law.place import place_of
from doormill_ros.diagnosis.law.search import LawSearch

#: Established numbers from which on it is less work to project them out once than to fit them beside every law.
_MANY = 50
#: Autocorrelation that is no more than chance.
_FADED = 0.1


@dataclass(frozen=True, eq=False)
class Searched:
    """A search for laws beside what a diagnosis has established.

    Attributes:
        problem: What was left to explain, rows counting as they did in the end.
        search: All that was tried.
        best: The best model; it holds no law where nothing can be said.
    """

    problem: LinearProblem
    search: LawSearch[Any]
    best: Fit[Any]

    @property
    def laws(self) -> list[Any]:
        """Terms that were found."""
        return self.search.laws(self.best)

    @property
    def total(self) -> float:
        """Held-out score with the prices of numbers and choices; smaller is better."""
        return self.search.total(self.best)

    @property
    def told(self) -> Characterised[Any] | None:
        """What is told of the laws; None without any."""
        return account(self.search, self.best, np.ones(len(self.problem), dtype=bool)) if self.laws else None


def searched(
    problem: LinearProblem,
    base: Established,
    terms: Sequence[Any],
    progress: Callable[[str], None] = lambda line: None,
) -> Searched:
    """Laws beside what a diagnosis has established.

    Args:
        problem: What is left to explain.
        base: What stays.
        terms: What may join.
        progress: Told of every step.
    """
    found = searched_once(problem, base, terms, progress)
    if found.laws and (left := excess(problem.white(found.best), problem)) >= AT_NOISE:
        # What no law holds errs alike from row to row: by that much less do rows say.
        return searched_once(problem.coarser(left), base, terms, progress)
    return found


def searched_once(
    problem: LinearProblem,
    base: Established,
    terms: Sequence[Any],
    progress: Callable[[str], None] = lambda line: None,
) -> Searched:
    """The same, rows counting as the problem says; arguments as of `searched`."""
    beside = Beside(problem, base) if base.size >= _MANY else None
    none = np.zeros(base.size)
    search = LawSearch(problem, [base], none, terms, place_of, progress, spread=True, beside=beside)
    return Searched(problem, search, search.run())


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
        alone = alone[:-1] & same[lag - 1 : -1]
        if not alone.any():
            break
        share = float(np.mean((held_out[:-lag] * held_out[lag:])[alone])) / power
        if share < _FADED:
            break
        count += 2.0 * share
    return float(np.sqrt(power * count))
