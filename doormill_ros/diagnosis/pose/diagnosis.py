"""From series of poses to a verdict: what is wrong, how sure, what the extended model gains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.examining.examination import Examination
from doormill_ros.diagnosis.core.judgement import Judgement, Question, judge_question
from doormill_ros.diagnosis.core.telling.characterised import Characterised
from doormill_ros.diagnosis.core.words.verdict import MAIN_PART
from doormill_ros.diagnosis.pose.examination import PoseExaminer
from doormill_ros.diagnosis.pose.fitting.fit import Fitted, deviation, fit_causes, place_nominally
from doormill_ros.diagnosis.pose.fitting.model import Errors, SeriesFit, rmse, standard_deviations
from doormill_ros.diagnosis.pose.fitting.noise import common_noise, evened
from doormill_ros.diagnosis.pose.fitting.validation import by_block
from doormill_ros.diagnosis.pose.searching.search import PoseSearch
from doormill_ros.diagnosis.pose.searching.selection import Score
from doormill_ros.diagnosis.pose.stance.standing import find_standing, stood
from doormill_ros.diagnosis.pose.together import check_names, check_together
from doormill_ros.measurements.sets.pose_set import PoseSet
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.law.term import PoseTerm
from doormill_ros.robot_model.pose.model import PoseModel
from doormill_ros.robot_model.pose.stance import UPRIGHT

#: Deviations from the nominal model beyond which a row is a gross error where nothing else is known to be wrong.
GROSS = 5.0


class PoseQuestion(Question[PoseCause, SeriesFit]):
    """Several series of one robot, each with a placement of its own.

    Attributes:
        sets: The series.
        standing: What the sag of the joints says of gravity and load, as soon as it was searched.
        scores: What each cause was worth when it was asked last, by its identity.
        gone: Causes that earned no place, in the order in which they left.
    """

    main_part = MAIN_PART
    examiner: PoseExaminer

    def __init__(self, sets: Sequence[PoseSet]) -> None:
        """Keep series that question the same model.

        Raises:
            SetMixError: They do not, or two have one name.
        """
        check_together(sets)
        check_names(sets)
        self.sets = tuple(sets)
        self.noise_floor = float(np.sqrt(3.0) * common_noise(sets)[0])
        self.scores: dict[int, Score] = {}
        self.gone: list[PoseCause] = []

    def search(self, progress: Callable[[str], None]) -> SeriesFit:
        """What is left of everything that may act."""
        rows = sum(len(data) for data in self.sets)
        progress(f"{rows} poses in {len(self.sets)} series; placing them under the nominal model")
        nominal = fit_causes(self.sets, (), place_nominally(self.sets), passes=2)
        self.standing = find_standing(self.sets, nominal, progress)
        if self.standing.stance is not UPRIGHT:
            # The nominal model, too, has these torques: laws beside it hang on them.
            self.sets = stood(self.sets, self.standing.stance)
            nominal = fit_causes(self.sets, (), nominal.problem.placements, passes=2)
        return self.searched(PoseSearch(self.sets, nominal, progress), nominal)

    def searched(self, search: PoseSearch, nominal: Fitted) -> SeriesFit:
        """What a search leaves that sets out from the nominal model."""
        best = search.run()
        self.scores, self.gone = search.scores, search.gone
        self.examiner = PoseExaminer(search, nominal, self.kept(best), self.noise_floor)
        return best

    def kept(self, best: SeriesFit) -> list[BoolArray]:
        """Rows of every series that are no gross errors, shape (n,) each."""
        return [weight > 0.0 for weight in best.problem.weights]

    def withdrawn(self, examination: Examination[PoseCause, SeriesFit]) -> Examination[PoseCause, SeriesFit]:
        """Nothing named: gross errors are those that the nominal model does not explain either."""
        baseline = examination.baseline
        kept = [
            good | (deviation(error, sigma, data.oriented) <= GROSS)
            for good, error, sigma, data in zip(
                examination.kept, baseline.errors.train, baseline.problem.sigmas, self.sets, strict=True
            )
        ]
        self.gone = [*examination.named, *self.gone]
        return replace(examination.withdrawn(), kept=kept)

    def train_rmse(self, model: SeriesFit, kept: Sequence[BoolArray]) -> float:
        """Length of the position error of fitted rows at the common noise, marks of shape (n,) for each series [m]."""
        return rmse(evened(self.sets, model.errors.train), kept)

    def holdout_rmse(self, model: SeriesFit, kept: Sequence[BoolArray]) -> float:
        """The same of blocks left out, marks of shape (n,) for each series [m]."""
        return rmse(evened(self.sets, model.errors.blocks), kept)

    def holdout_squares(self, model: SeriesFit, kept: Sequence[BoolArray]) -> FloatArray:
        """The same by block of every series, shape (blocks,)."""
        pairs = zip(evened(self.sets, model.errors.blocks), kept, strict=True)
        return np.concatenate(by_block([np.sum(e[:, :3] ** 2, axis=1) * good for e, good in pairs]))


@dataclass(frozen=True, eq=False)
class PoseDiagnosis(Judgement[PoseCause, SeriesFit]):
    """Everything that a diagnosis of poses knows.

    Attributes:
        question: The series, and what each cause was worth.
        laws: Laws without a name for what the causes leave, where any was found.
    """

    question: PoseQuestion
    laws: Characterised[PoseTerm] | None = None

    @property
    def sets(self) -> tuple[PoseSet, ...]:
        """The series."""
        return self.question.sets

    @property
    def noise_floor(self) -> float:
        """3-D position error that the tracker's noise alone leaves [m]."""
        return self.question.noise_floor

    @property
    def established(self) -> list[Score]:
        """Scores of the established causes, gross errors aside."""
        return [self.question.scores[id(cause)] for cause in self.examination.named]

    @property
    def rejected(self) -> list[Score]:
        """Scores of the others; what was taken back after it had helped has the reason of that."""
        taken_back = {id(cause): why for cause, why in self.examination.refused}
        # One that left while something else was tried may be back.
        gone = [cause for cause in self.question.gone if cause not in self.examination.named]
        scores = [self.question.scores[id(cause)] for cause in gone]
        return [replace(one, status=taken_back.get(id(one.cause), one.status)) for one in scores]

    @property
    def gross(self) -> list[BoolArray]:
        """Rows of every series that are gross errors, shape (n,) each."""
        return [~good for good in self.examination.kept]

    @property
    def before(self) -> Errors:
        """Residuals of the nominal model."""
        return self.baseline.errors

    @property
    def after(self) -> Errors:
        """Residuals of the extended model."""
        return self.extended.errors

    @cached_property
    def std(self) -> FloatArray:
        """Standard deviation of every coefficient of the extended fit, shape (m,)."""
        return standard_deviations(self.extended)

    @property
    def model(self) -> PoseModel:
        """What holds for the robot itself."""
        problem = self.extended.problem
        data = problem.sets[0]
        chosen = [(cause, part) for cause, part in self.extended.parts if cause.of_robot]
        x = np.concatenate([np.zeros(0), *(problem.x[part] for _, part in chosen)])
        causes = tuple(cause for cause, _ in chosen)
        return PoseModel(data.robot, data.dh, problem.views[0].links, causes, x, stance=data.stance)


def diagnose_poses(
    sets: Sequence[PoseSet], progress: Callable[[str], None] = lambda line: None
) -> PoseDiagnosis:
    """Question the nominal model of a robot with several series."""
    question = PoseQuestion(sets)
    return PoseDiagnosis(**vars(judge_question(question, progress)), question=question)
