"""What a search for laws is worth: repeated without some postures, choice of terms included, and asked about those.

A residual of postures that were left out of the fit alone is too small where the choice among thousands of terms was
made on them: Stone, Cross-validatory choice and assessment of statistical predictions, 1974.
"""

from __future__ import annotations

from functools import cached_property
from typing import Generic

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C, make_folds
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.law.some_rows import SomeRows
from doormill_ros.statistics import resampled

_FOLDS = 5  #: each costs a search
_DRAWS = 4000  #: of configurations
_CHANCE = 0.025  #: that laws without any use seem to predict better


class Repeated(Generic[C]):
    """A search repeated without some postures, for fewer and fewer laws if asked to."""

    def __init__(self, search: LawSearch[C], kept: BoolArray) -> None:
        """Keep what is repeated.

        Args:
            search: Over all rows; those without a fold are like it.
            kept: Rows that count, shape (n,).
        """
        self._problem, self._kept = search.problem, kept
        folds = make_folds(self._problem.configuration, _FOLDS)
        self._again = [
            (folds == fold, search.on(SomeRows(self._problem, folds != fold)))
            for fold in range(int(folds.max()) + 1)
        ]

    def unseen_residual(self, most: int) -> FloatArray | None:
        """What causes and `most` laws leave of rows unseen, shape (n, c); None if no less than the causes alone."""
        problem, kept, causes = self._problem, self._kept, self._by_causes
        laws = np.zeros_like(causes)
        for out, one in self._again:
            laws[out] = self._white(one.at_most(most).run())[out]
            # Rows that are still to come are predicted without error at best.
            if np.sum(laws[kept] ** 2) >= np.sum(causes[kept] ** 2):
                return None
        gain = np.sum(causes**2 - laws**2, axis=1)[kept]
        of_each = np.bincount(np.unique(problem.configuration[kept], return_inverse=True)[1], weights=gain)
        drawn = of_each[resampled(len(of_each), _DRAWS)].sum(axis=1)
        return problem.measured_part(laws) if np.quantile(drawn, _CHANCE) > 0.0 else None

    @cached_property
    def _by_causes(self) -> FloatArray:
        """What the causes alone leave of rows unseen, in standard deviations, shape (n, c)."""
        causes = np.zeros((len(self._problem), self._problem.components))
        for out, one in self._again:
            causes[out] = self._white(one.starts()[0])[out]
        return causes

    def _white(self, found: Fit[C]) -> FloatArray:
        return self._problem.predict(found.members, found.theta).white
