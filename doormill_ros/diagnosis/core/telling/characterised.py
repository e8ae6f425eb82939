"""What is known of a remainder that no cause names: laws, and how well they predict what was left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C, Problem


@dataclass(frozen=True, eq=False)
class Rival(Generic[C]):
    """Another place or driver that the data hardly tell from a law's: the term, and how far its score is behind."""

    term: C
    where: str
    driver: str
    behind: float


@dataclass(frozen=True, eq=False)
class UnnamedLaw(Generic[C]):
    """What acts at one place and is driven by one thing.

    Attributes:
        where: Joint, link, tool, base, sensor, tracker or reflector.
        acts_on: What there is off.
        driver: What drives it.
        law: One line with numbers and units.
        terms: Of the fitted model.
        without: Held-out RMSE of that model less the terms.
        rivals: Other places and drivers that would do nearly as well, the best first.
        test: What would tell what it is.
    """

    where: str
    acts_on: str
    driver: str
    law: str
    terms: tuple[C, ...]
    without: float
    rivals: tuple[Rival[C], ...]
    test: str

    def document(self) -> dict[str, Any]:
        """One of `unnamed` of diagnosis.json."""
        return {
            "where": self.where,
            "acts_on": self.acts_on,
            "driver": self.driver,
            "law": self.law,
            "holdout_rmse_without": self.without,
            "rivals": [{"where": r.where, "driver": r.driver, "score_behind": r.behind} for r in self.rivals],
            "test": self.test,
        }


@dataclass(frozen=True, eq=False)
class Characterised(Generic[C]):
    """Established causes with laws for what they leave.

    Attributes:
        fit: The model of both.
        laws: In the order of what each gains.
        holdout_rmse: Of configurations left out.
        by_configuration: Mean square of each of them, shape (configurations,).
        interval: Its 95 % interval, by resampling the configurations.
        problem: What was left to explain.
    """

    fit: Fit[C]
    laws: Sequence[UnnamedLaw[C]]
    holdout_rmse: float
    by_configuration: FloatArray
    interval: tuple[float, float]
    problem: Problem[C]

    def document(self) -> dict[str, Any]:
        """`unnamed` and `characterised` of diagnosis.json."""
        return {
            "unnamed": [law.document() for law in self.laws],
            "characterised": {"holdout_rmse": self.holdout_rmse, "ci95": list(self.interval)},
        }

    def weights(self, term: C) -> FloatArray:
        """Values of a term's numbers, SI, shape (v,)."""
        return term.values(self.fit.theta[self.fit.part(term)], self.problem.case)
