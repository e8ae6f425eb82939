"""Any problem that robust least squares can fit, from search to verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.examining.examination import Examination
from doormill_ros.diagnosis.core.examining.finding import Finding, make_findings
from doormill_ros.diagnosis.core.examining.fit_examiner import FitExaminer
from doormill_ros.diagnosis.core.examining.stability import clustered, turned_joint
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C, Examined
from doormill_ros.diagnosis.core.fitting.robust import gross_errors
from doormill_ros.diagnosis.core.judgement import Judgement, Question, judge_question, less, weighed
from doormill_ros.diagnosis.core.searching.beam import BeamSearch
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.core.words.verdict import rmse

P = TypeVar("P", bound=Examined[Any])


@dataclass(frozen=True, eq=False)
class Diagnosis(Judgement[C, Fit[C]], Generic[P, C]):
    """Everything that a diagnosis knows.

    Attributes:
        question: The set made ready, and all models that were tried.
        findings: Established causes.
        outliers: Trial numbers.
        remarks: Sentences for the reader.
        characterised: Laws without a name for what the findings leave, where any was found.
    """

    question: FittedQuestion[P, C]
    findings: tuple[Finding[C], ...]
    outliers: tuple[int, ...]
    remarks: tuple[str, ...]
    characterised: Characterised[C] | None = None

    @property
    def problem(self) -> P:
        """The set made ready."""
        return self.question.problem

    @property
    def search(self) -> BeamSearch[C]:
        """All models that were tried."""
        return self.question.models

    @property
    def kept(self) -> BoolArray:
        """Trials that count, shape (n,)."""
        return np.asarray(self.examination.kept, dtype=bool)

    def less(self, causes: Sequence[C], why: str) -> Diagnosis[P, C]:
        """The same without some names, for a reason, weighed anew and without laws."""
        return told(self.question, less(self.question, self, causes, why))

    def saying(self, model: Fit[C]) -> Diagnosis[P, C]:
        """What is said where another model is taken for the best one."""
        return told(self.question, weighed(self.question, self.question.examine(model)))


def diagnose_problem(problem: P, progress: Callable[[str], None] = lambda line: None) -> Diagnosis[P, C]:
    """Search, examine and weigh what any kind of data says."""
    progress(
        f"{len(problem)} trials in {len(np.unique(problem.configuration))} configurations, "
        f"noise floor {problem.unit.figure(problem.noise_floor)} {problem.unit.told}"
    )
    question: FittedQuestion[P, C] = FittedQuestion(problem)
    return told(question, judge_question(question, progress))


def told(question: FittedQuestion[P, C], found: Judgement[C, Fit[C]]) -> Diagnosis[P, C]:
    """A judgement with its causes sized."""
    problem, examination = question.problem, found.examination
    return Diagnosis(
        **vars(found),
        question=question,
        findings=make_findings(question.models, examination, not question.at_noise(examination.best)),
        outliers=tuple(int(t) for t in problem.labels()[~examination.kept]),
        remarks=_remarks(problem, examination),
    )


class FittedQuestion(Question[C, Fit[C]], Generic[P, C]):
    """A problem with all models of it that were fitted.

    Attributes:
        problem: The set, of a finer model where that was found better.
        models: All that were tried.
    """

    main_part = 0.0  # every cause has explained its own part

    def __init__(self, problem: P) -> None:
        self.problem, self.noise_floor = problem, problem.noise_floor

    def search(self, progress: Callable[[str], None]) -> Fit[C]:
        """The best model, by finite joint angles where these matter."""
        self.models: BeamSearch[C] = BeamSearch(self.problem, self.problem.candidates(), progress)
        best = self.models.run()
        bent = self.problem.bent()
        if bent is not None:
            # Heavy loads: first-order and finite joint angles differ by more than the noise.
            progress("large deflections: trying finite joint angles")
            other: BeamSearch[C] = BeamSearch(bent, bent.candidates(), progress)
            found = other.run()
            if other.total(found) < self.models.total(best):
                self.models, best, self.problem = other, found, bent
        self.examiner = FitExaminer(self.problem, self.models)
        return best

    def kept(self, best: Fit[C]) -> BoolArray:
        """Gross errors set aside, shape (n,)."""
        return ~gross_errors(best.prediction.cost, self.problem.components)

    def train_rmse(self, model: Fit[C], kept: BoolArray) -> float:
        """Of fitted trials; `kept` marks those that count, shape (n,)."""
        return rmse(self.problem.measured_part(model.prediction.white), kept, self.problem.components)

    def holdout_rmse(self, model: Fit[C], kept: BoolArray) -> float:
        """Of trials left out; `kept` marks those that count, shape (n,)."""
        return rmse(model.held_out, kept, self.problem.components)

    def holdout_squares(self, model: Fit[C], kept: BoolArray) -> FloatArray:
        """By what was left out together, shape (k,): configurations, single trials where there is one of these."""
        configuration = self.problem.configuration
        numbers = np.unique(configuration[kept])
        if len(numbers) == 1:
            return np.asarray(np.sum(model.held_out[kept] ** 2, axis=1), dtype=float)
        return np.array([np.sum(model.held_out[kept & (configuration == c)] ** 2) for c in numbers])


def _remarks(problem: Examined[C], examination: Examination[C, Fit[C]]) -> tuple[str, ...]:
    best, outliers, lines = examination.best, ~examination.kept, []
    joint = turned_joint(problem, best.prediction.white, outliers)
    if joint:
        lines.append(
            f"The trials that look like gross errors all point along a turn of {joint}: an effect, not slips."
        )
    elif clustered(problem, outliers):
        lines.append("The trials that look like gross errors sit together: an effect, not slips.")
    if len(np.unique(problem.configuration)) == 1:
        lines.append(
            "All trials share one configuration, so single trials were left out instead of configurations."
        )
    unnamed = [cause for cause in best.members if not cause.named]
    if unnamed:
        lines.append(
            "The residual looks like "
            + " and ".join(c.pattern() for c in unnamed)
            + ", which no known cause leaves."
        )
    lines += [f"{cause!r} comes closest but is not believed: {why}." for cause, why in examination.refused]
    return tuple(lines)
