"""From recordings of moving joints to a verdict: what lies between the encoders, how sure, what the model gains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.examination import Double, Examination, compared, examined
from doormill_ros.diagnosis.core.judgement import Judgement, Question, judge_question
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.core.words.verdict import MAIN_PART
from doormill_ros.diagnosis.law.linear import LinearProblem
from doormill_ros.diagnosis.motion.certainty import beside_remainder, in_doubt
from doormill_ros.diagnosis.motion.examination import JointExaminer, JointFinding
from doormill_ros.diagnosis.motion.model import JointFit, model_of
from doormill_ros.diagnosis.motion.needless import explains
from doormill_ros.diagnosis.motion.patterns import unnamed_patterns
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.diagnosis.motion.remainder import beside_laws
from doormill_ros.diagnosis.motion.search import JointSearch
from doormill_ros.diagnosis.motion.skew import common_skew, own_skews, without_delays
from doormill_ros.measurements.sets.motion_set import MotionSet
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.causes.time_skew import TimeSkew
from doormill_ros.robot_model.motion.law.term import MotionTerm
from doormill_ros.robot_model.motion.model import MotionModel
from doormill_ros.statistics import root_mean_square
from doormill_ros.units import s_to_ms

#: Where all link encoders are late together.
ENCODERS = "link encoders"


@dataclass(frozen=True, eq=False)
class MotionFit:
    """A model of all joints.

    Attributes:
        joints: Of each joint.
        skew, skew_std: By which all link encoders are late together, and its standard deviation; 0 for none [s].
    """

    joints: tuple[JointFit, ...]
    skew: float = 0.0
    skew_std: float = 0.0

    @property
    def members(self) -> tuple[MotionCause, ...]:
        """Causes of all joints, what the encoders have in common first."""
        common = (TimeSkew(ENCODERS),) if self.skew else ()
        return (*common, *(cause for fit in self.joints for cause in fit.members))


class MotionQuestion(Question[MotionCause, MotionFit]):
    """Recordings of the same joints; these have nothing in common but the clock of their encoders.

    Attributes:
        sets: The recordings.
        problems: Each joint made ready.
        joints: What was found in each.
    """

    main_part = MAIN_PART

    def __init__(self, sets: Sequence[MotionSet]) -> None:
        """Put the recordings of each joint together."""
        self.sets, self._motions = tuple(sets), [one.motions for one in sets]
        self.problems = [
            JointProblem(tuple(recording[k] for recording in self._motions), sets[0].noise)
            for k in range(len(sets[0].joints))
        ]
        self.noise_floor = root_mean_square([problem.floor for problem in self.problems])
        self.joints: tuple[JointFinding, ...] = ()
        self._searches: list[JointSearch] = []

    def search(self, progress: Callable[[str], None]) -> MotionFit:
        """Each joint by itself; once more where all encoders turn out to be late together."""
        problems = self.problems
        patterns = [unnamed_patterns(k, self._motions) for k in range(len(problems))]
        every = list(zip(problems, patterns, strict=True))
        self._searches = [JointSearch(*one, progress=progress) for one in every]
        fits = [search.run() for search in self._searches]
        skew, std, agreed = common_skew(
            own_skews(fits), len(problems), lambda index: _asked_skew(problems[index], fits[index])
        )
        if not agreed:
            return MotionFit(tuple(fits))
        progress(
            f"the link encoders are {'late' if skew > 0.0 else 'early'} together by {s_to_ms(abs(skew)):.3f} ms"
        )
        self._searches = [JointSearch(*one, skew, False, progress) for one in every]
        again = [
            search.run([search.fit(without_delays(fit))])
            for search, fit in zip(self._searches, fits, strict=True)
        ]
        return MotionFit(tuple(again), skew, std)

    def examine(self, best: MotionFit) -> Examination[MotionCause, MotionFit]:
        """Each joint by itself."""
        self.joints = tuple(
            JointFinding(**vars(examined(examiner, fit)), examiner=examiner)
            for examiner, fit in zip(map(JointExaminer, self._searches), best.joints, strict=True)
        )
        return self._examination(best, best.skew)

    def withdrawn(
        self, examination: Examination[MotionCause, MotionFit]
    ) -> Examination[MotionCause, MotionFit]:
        """The same with nothing named in any joint."""
        self.joints = tuple(finding.withdrawn() for finding in self.joints)
        return self._examination(examination.best, 0.0)

    def less(
        self,
        examination: Examination[MotionCause, MotionFit],
        back: Sequence[Sequence[tuple[MotionCause, str]]],
    ) -> Examination[MotionCause, MotionFit]:
        """The same without some names of each joint, each with the reason."""
        self.joints = tuple(
            finding.less(part) if part else finding for finding, part in zip(self.joints, back, strict=True)
        )
        return self._examination(examination.best, examination.extended.skew)

    def compared(
        self, examination: Examination[MotionCause, MotionFit]
    ) -> Examination[MotionCause, MotionFit]:
        """Each joint by itself; what all encoders have in common has no double."""
        self.joints = tuple(compared(finding.examiner, finding) for finding in self.joints)
        return self._examination(examination.best, examination.extended.skew)

    def _examination(self, best: MotionFit, skew: float) -> Examination[MotionCause, MotionFit]:
        asked, baseline, extended = (
            MotionFit(tuple(getattr(finding, name) for finding in self.joints))
            for name in ("asked", "baseline", "extended")
        )
        extended = replace(extended, skew=skew, skew_std=best.skew_std)
        common: tuple[tuple[Double[MotionCause, Any], ...], ...] = ((),) if skew else ()
        return Examination(
            best=best,
            asked=asked,
            baseline=baseline,
            extended=extended,
            named=extended.members,
            refused=tuple(entry for finding in self.joints for entry in finding.refused),
            kept=None,
            margins=tuple(margin for finding in self.joints for margin in finding.margins),
            doubles=(*common, *(doubles for finding in self.joints for doubles in finding.doubles)),
        )

    def at_noise(self, model: MotionFit) -> bool:
        """Whether every joint is."""
        return not any(
            finding.examiner.remains(fit) for finding, fit in zip(self.joints, model.joints, strict=True)
        )

    def share(self, found: Examination[MotionCause, MotionFit]) -> float:
        """In the joints that have names: what remains in another joint says nothing against these."""
        named = [i for i, fit in enumerate(found.extended.joints) if fit.members]
        if found.extended.skew or not named:
            return super().share(found)
        before, after = (
            sum(self.problems[i].rmse(model.joints[i].held_out) ** 2 for i in named)
            for model in (found.baseline, found.extended)
        )
        return (before - after) / max(before - sum(self.problems[i].floor ** 2 for i in named), 1e-30)

    def train_rmse(self, model: MotionFit, kept: None = None) -> float:
        """Over all joints [rad]."""
        return self._rmse([fit.residual for fit in model.joints])

    def holdout_rmse(self, model: MotionFit, kept: None = None) -> float:
        """Over all joints, blocks left out [rad]."""
        return self._rmse([fit.held_out for fit in model.joints])

    def _rmse(self, errors: Sequence[FloatArray]) -> float:
        return root_mean_square([p.rmse(own) for p, own in zip(self.problems, errors, strict=True)])

    def holdout_squares(self, model: MotionFit, kept: None = None) -> FloatArray:
        """Of all joints by block of time, shape (blocks,)."""
        by_joint = [p.by_block(fit.held_out) for p, fit in zip(self.problems, model.joints, strict=True)]
        return np.asarray(np.sum(by_joint, axis=0), dtype=float)


@dataclass(frozen=True, eq=False)
class MotionDiagnosis(Judgement[MotionCause, MotionFit]):
    """Everything that a diagnosis of moving joints knows.

    Attributes:
        question: The recordings, and what was found in each joint.
        laws: Laws without a name for what the causes of each joint leave, None where nothing can be said; empty where
            nothing was asked.
    """

    question: MotionQuestion
    laws: tuple[Characterised[MotionTerm] | None, ...] = ()

    @property
    def sets(self) -> tuple[MotionSet, ...]:
        """The recordings."""
        return self.question.sets

    @property
    def joints(self) -> tuple[JointFinding, ...]:
        """What was found in each joint."""
        return self.question.joints

    @property
    def noise_floor(self) -> float:
        """Root mean square of the noise over all joints [rad]."""
        return self.question.noise_floor

    @property
    def without_skew(self) -> float:
        """Held-out RMSE of the extended model less the delay that all encoders have in common [rad]."""
        fits = [one.problem.fit(one.extended.members, 0.0) for one in self.joints]
        return self.question.holdout_rmse(MotionFit(tuple(fits)))

    @cached_property
    def told(self) -> tuple[JointFit, ...]:
        """The causes of each joint with the numbers that are told of them: those beside its laws, where it has any."""
        fits = []
        for one, laws in zip(self.joints, self.laws or (None,) * len(self.joints), strict=True):
            if laws is None:
                fits.append(in_doubt(one))
            else:
                assert isinstance(laws.problem, LinearProblem)
                told = beside_laws(one.problem, one.extended, laws.problem, laws.fit)
                fits.append(told if explains(one, laws.fit) else beside_remainder(told, in_doubt(one)))
        return tuple(fits)

    @property
    def model(self) -> MotionModel:
        """What was established."""
        joints = [model_of(one.extended, one.problem.motions[0]) for one in self.joints]
        return MotionModel(self.sets[0].robot, tuple(joints))


def diagnose_motions(
    sets: Sequence[MotionSet], progress: Callable[[str], None] = lambda line: None
) -> MotionDiagnosis:
    """Question the springs of a robot with recordings of its joints in motion."""
    question = MotionQuestion(sets)
    return MotionDiagnosis(**vars(judge_question(question, progress)), question=question)


def _asked_skew(problem: JointProblem, fit: JointFit) -> tuple[float, float]:
    """Skew of a joint whose model holds none, and its standard deviation [s]."""
    found = problem.settled((*without_delays(fit), TimeSkew(problem.where)), fit.delay)
    index = len(found.members) - 1
    return found.late, float(found.std[index][0])
