"""What the causes of a joint have to stand, and what was found of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

from doormill_ros.diagnosis.core.examining.examination import MOST_REMAINS, Double, Examination, Examiner
from doormill_ros.diagnosis.core.words.margin import Check, Margin
from doormill_ros.diagnosis.core.words.verdict import AT_NOISE
from doormill_ros.diagnosis.motion.imitations import in_place_of_scale, lag_beyond_delay, part_of_a_wave
from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.diagnosis.motion.orders import outermost
from doormill_ros.diagnosis.motion.patterns import MotionPattern
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.diagnosis.motion.search import CLEAR, ENTRY, EQUAL, JointSearch
from doormill_ros.diagnosis.motion.skew import alike
from doormill_ros.robot_model.motion.causes.cause import TORQUE, MotionCause
from doormill_ros.robot_model.motion.causes.joint_periodic_error import MotionPeriodicError

#: Share of the excess over the noise that a joint's causes explain together to be named where something remains.
JOINT_PART = 0.8


class JointExaminer(Examiner[MotionCause, JointFit]):
    """All models of one joint, held against the scatter of its blocks and against shapes without a name."""

    models: JointSearch
    equal = EQUAL

    def __init__(self, models: JointSearch) -> None:
        """Keep the search."""
        self.models, self.problem = models, models.problem

    def baseline(self) -> JointFit:
        """The offsets alone."""
        return self.problem.fit(())

    def noise(self, model: JointFit) -> Sequence[Check]:
        """The held-out residual over the noise."""
        left = self.problem.rmse(model.held_out)
        decision = f"{self.problem.where} is at the noise, which leaves a share"
        margin = Margin(decision, left / self.problem.floor, AT_NOISE, "share")
        return [Check(left > AT_NOISE * self.problem.floor, margins=(margin,))]

    def checks(self, best: JointFit, cause: MotionCause, remains: bool) -> Sequence[Check]:
        """Clear of zero, and no shape without a name explains more in its place or says that its law is another."""
        found = [self._clear(best, cause)]
        if not found[0].fails and (rival := self._shape_instead(best, cause)) is not None:
            found.append(Check(True, f"{rival!r} explains more"))
        if part_of_a_wave(self.models, best, cause):
            found.append(Check(True, "a part of one wave a turn does as well"))
        if lag_beyond_delay(self.models, best, cause):
            found.append(Check(True, "what a filter does beyond a delay does as well"))
        if not remains:
            spoiled = any(shape.spoils(cause) for shape in self._shapes(best))
            found.append(Check(spoiled, "a shape without a name beside it says that its law is another"))
        return found

    def _clear(self, model: JointFit, cause: MotionCause) -> Check:
        strength = self.models.strength(model, cause)
        margin = Margin(f"{cause!r} is clear of zero", strength, CLEAR, "standard errors")
        return Check(not strength > CLEAR, "its size changes too much between the blocks", (margin,))

    def _shapes(self, best: JointFit) -> list[MotionPattern]:
        """Those in a model, and those that take the place of one of its causes."""
        own = [shape for shape in best.members if isinstance(shape, MotionPattern)]
        clear = [cause for cause in best.members if cause.named and not self._clear(best, cause).fails]
        others = [self._shape_instead(best, cause) for cause in clear]
        return [*own, *(shape for shape in others if shape is not None)]

    def _shape_instead(self, best: JointFit, cause: MotionCause) -> MotionPattern | None:
        """A shape without a name that explains clearly more in the place of a cause.

        In the place of a slow wave it is enough that a law of the joint's torque, which gravity ties to its angle, does
        as well.
        """
        for other, fit in self.models.rivals(best, cause):
            if not isinstance(other, MotionPattern):
                continue
            least = -EQUAL if cause.slow and other.driver in TORQUE else ENTRY
            if self.models.gain(best, fit).score > least:
                return other
        return None

    def settled(
        self,
        best: JointFit,
        named: Sequence[MotionCause],
        refused: Sequence[tuple[MotionCause, str]],
        remains: bool,
    ) -> tuple[JointFit, JointFit, Sequence[tuple[MotionCause, str]]]:
        """Less what makes a recording worse that was left out as a whole; nothing where most remains."""
        search, problem = self.models, self.problem
        # Where a shape without a name brings a joint to its noise, causes that would imitate it are not asked for.
        if remains and len(named) < len(best.members):
            wrong = {cause.slot for cause, _ in refused}
            found = search.named_only(named)
            named = [
                cause
                for cause in found.members
                if cause.slot not in wrong and not self._clear(found, cause).fails
            ]
        extended, dropped = search.transferred(problem.settled(named, search.delay))
        later = [(cause, "it makes a recording worse that was left out") for cause in dropped]
        before, after = (problem.rmse(model.held_out) for model in (self.baseline(), extended))
        share = (before**2 - after**2) / max(before**2 - problem.floor**2, 1e-30)
        if extended.members and self.remains(extended) and share < JOINT_PART:
            later += [(cause, MOST_REMAINS) for cause in extended.members]
            extended = problem.settled((), search.delay)
        return extended, extended, later

    def worth(self, asked: JointFit) -> Sequence[Margin]:
        """Fall of the held-out error by each member, in independent squares."""
        gains = [
            (cause, self.models.gain(self.models.without(asked, cause), asked).score)
            for cause in asked.members
        ]
        return [Margin(f"{cause!r} stays", gain, ENTRY, "score") for cause, gain in gains]

    def behind(self, model: JointFit, rival: JointFit) -> float:
        """By the held-out error, in independent squares."""
        return self.models.gain(rival, model).score

    def doubles(self, asked: JointFit, cause: MotionCause) -> Sequence[Double[MotionCause, JointFit]]:
        """Other causes that would do as well in the place of one, each at its best."""
        found: dict[tuple[str, ...], Double[MotionCause, JointFit]] = {}
        for other, fit in self.models.rivals(asked, cause):
            behind = self.behind(asked, fit)
            if other.named and other.key != cause.key and behind < EQUAL:
                found.setdefault(other.key, Double(other, max(behind, 0.0), model=fit))
        if (same := alike(cause, asked.late)) is not None:
            found.setdefault(same.key, Double(same, 0.0))
        for other, fit in in_place_of_scale(self.models, asked, cause):
            if (behind := self.behind(asked, fit)) < EQUAL or not (self.remains(asked) or self.remains(fit)):
                found.setdefault(other.key, Double(other, max(behind, 0.0), model=fit))
        if isinstance(cause, MotionPeriodicError):
            orders = {
                other: Double[MotionCause, JointFit](other, max(behind, 0.0), model=fit)
                for other, fit in self.models.other_orders(asked, cause)
                if (behind := self.behind(asked, fit)) < EQUAL
            }
            found |= {other.slot: orders[other] for other in outermost(cause, orders)}
        return tuple(found.values())


@dataclass(frozen=True, eq=False, kw_only=True)
class JointFinding(Examination[MotionCause, JointFit]):
    """What was found in one joint.

    Attributes:
        examiner: All that was tried, and the problem.
    """

    examiner: JointExaminer

    @property
    def search(self) -> JointSearch:
        """All that was tried."""
        return self.examiner.models

    @property
    def problem(self) -> JointProblem:
        """The joint made ready."""
        return self.examiner.problem

    def less(self, back: Sequence[tuple[MotionCause, str]]) -> Self:
        """The same without some names, each with the reason; without any where the others explain too little."""
        gone = [cause for cause, _ in back]
        rest = [cause for cause in self.named if cause not in gone]
        asked, extended, later = self.examiner.settled(self.best, rest, (), False)
        return replace(
            self,
            asked=asked,
            extended=extended,
            named=extended.members,
            refused=(*self.refused, *back, *later),
            doubles=(),
        )
