"""What the causes of pose errors have to stand, and which of them lean on each other."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.arrays import BoolArray
from doormill_ros.diagnosis.core.examining.examination import Double, Examiner
from doormill_ros.diagnosis.core.fitting.ridge import leans
from doormill_ros.diagnosis.core.words.margin import Check, Margin
from doormill_ros.diagnosis.core.words.verdict import AT_NOISE
from doormill_ros.diagnosis.pose.fitting.fit import Fitted
from doormill_ros.diagnosis.pose.fitting.model import SeriesFit, rmse
from doormill_ros.diagnosis.pose.fitting.noise import evened
from doormill_ros.diagnosis.pose.fitting.validation import Validation
from doormill_ros.diagnosis.pose.searching.search import PoseSearch
from doormill_ros.diagnosis.pose.searching.selection import SURE
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.session_step import SessionStep
from doormill_ros.robot_model.pose.causes.thermal_drift import PoseDrift


class PoseExaminer(Examiner[PoseCause, SeriesFit]):
    """What is left of everything that may act.

    Attributes:
        nominal: How the nominal model places the series.
        kept: Rows of every series that count, shape (n,) each.
        noise_floor: 3-D position error that the tracker's noise alone leaves [m].
    """

    models: PoseSearch
    equal = 0.0  # nothing takes the place of anything: everything that may act was in from the start

    def __init__(
        self, models: PoseSearch, nominal: Fitted, kept: Sequence[BoolArray], noise_floor: float
    ) -> None:
        """Keep the search and what it started from; marks of rows that count of shape (n,) for each series."""
        self.models, self.nominal, self.kept, self.noise_floor = models, nominal, kept, noise_floor

    def baseline(self) -> SeriesFit:
        """The nominal model."""
        return SeriesFit((), self.nominal, Validation(self.nominal))

    def noise(self, model: SeriesFit) -> Sequence[Check]:
        """The error of blocks left out over the noise."""
        left = rmse(evened(model.problem.sets, model.errors.blocks), self.kept) / self.noise_floor
        name = "extended" if model.members else "nominal"
        margin = Margin(f"the {name} model is at the noise, which leaves a share", left, AT_NOISE, "share")
        return [Check(left > AT_NOISE, margins=(margin,))]

    def checks(self, best: SeriesFit, cause: PoseCause, remains: bool) -> Sequence[Check]:
        """All that is left has proved itself on rows left out."""
        return ()

    def settled(
        self,
        best: SeriesFit,
        named: Sequence[PoseCause],
        refused: Sequence[tuple[PoseCause, str]],
        remains: bool,
    ) -> tuple[SeriesFit, SeriesFit, Sequence[tuple[PoseCause, str]]]:
        """The best model; where laws acted beside its causes, these fitted anew without them."""
        if len(named) == len(best.members):
            return best, best, ()
        # Sizes that were learnt beside the laws hold nothing of what these leave.
        return best, self.models.settled(SeriesFit(tuple(named), best.fitted, best.validation)), ()

    def worth(self, asked: SeriesFit) -> Sequence[Margin]:
        """What each cause takes away of the error of blocks left out, those that left the model included."""
        causes = (cause for cause in (*asked.members, *self.models.gone) if cause.named)
        scores = [self.models.scores[id(cause)] for cause in causes]
        return [
            Margin(f"{score.cause!r} helps on blocks left out", score.total_sure, SURE, "standard errors")
            for score in scores
        ]

    def behind(self, model: SeriesFit, rival: SeriesFit) -> float:
        """By the cost of rows left out."""
        return float("inf")

    def doubles(self, asked: SeriesFit, cause: PoseCause) -> Sequence[Double[PoseCause, SeriesFit]]:
        """Causes of the same fit whose effects overlap; of a scale, the geometry of links that would tell the same.

        And the other way round where too few lengths ask for a scale; of what moved the base, other forms.
        """
        layout = asked.problem.layout
        own = layout.part(layout.causes.index(cause))
        instead = self.models.instead if cause.for_lengths else []
        if (scale := self.models.scale_instead.get(id(cause))) is not None:
            instead = [scale]
        leaning: list[Double[PoseCause, SeriesFit]] = [
            Double(other)
            for index, other in enumerate(layout.causes)
            if other is not cause
            and other.named
            and leans(asked.problem.x, asked.solution.covariance, own, layout.part(index))
        ]
        if cause.name in (SessionStep.name, PoseDrift.name):
            moved = self.models.moved_otherwise.get(cause.where, ())
            instead = [*instead, *(other for other in moved if other.name != cause.name)]
        known = {double.cause.key for double in leaning}
        others = {other.key: other for other in instead if other.key not in known}
        return [*leaning, *map(Double, others.values())]
