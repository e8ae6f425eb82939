"""Finds which causes earn their place in one joint: step by step, scored on blocks that were left out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.held_out import gain_in_errors
from doormill_ros.diagnosis.core.fitting.ranking import ranked, ranks
from doormill_ros.diagnosis.core.searching.search import Search
from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.diagnosis.motion.orders import neighbours, wave_candidates
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.causes.joint_periodic_error import MotionPeriodicError
from doormill_ros.robot_model.motion.causes.registry import candidates

#: Fall of the held-out error, in squares of what one independent sample is off by, that a cause has to bring, and what
#: each of its numbers costs on top. Chance brings it once in ten thousand shapes.
ENTRY, NUMBER = 16.0, 2.0
#: The same over its scatter between the blocks.
SURE = 2.2
#: Both for the slowest waves: a few of them can stand for whatever is slow.
SLOW_ENTRY, SLOW_SURE = 40.0, 3.2
#: Share of what is left that a cause takes away at least.
WORTH = 0.05
#: Score within which two models are equally good.
EQUAL = 8.0
#: Standard deviations that every named coefficient is away from zero.
CLEAR = 4.0
#: What a shape without a name has to be better by.
PENALTY = 4.0
_ALIKE = 10.0  #: samples that count as one when models are ranked


@dataclass(frozen=True, eq=False)
class Gain:
    """What one model has before another.

    Attributes:
        score: Fall of the held-out error in independent squares, less what the numbers cost.
        sure: The fall over its standard error between blocks.
        share: The fall as a share of what is left.
    """

    score: float
    sure: float
    share: float

    def enough(self, cause: MotionCause) -> bool:
        """Whether it is more than chance, and matters, for a cause that one model has before the other."""
        entry, sure = (SLOW_ENTRY, SLOW_SURE) if cause.slow else (ENTRY, SURE)
        return self.score > entry and self.sure > sure and self.share > WORTH


class JointSearch(Search[MotionCause, JointFit]):
    """All models of one joint that were tried."""

    largest, looked_at, swaps, shapes_last = 10, 5, 3, True

    def __init__(
        self,
        problem: JointProblem,
        patterns: Sequence[MotionCause],
        delay: float = 0.0,
        skewed: bool = True,
        progress: Callable[[str], None] = lambda line: None,
    ) -> None:
        """Keep what may enter.

        Args:
            problem: The joint.
            patterns: Shapes without a name that may enter too.
            delay: At which the joint is seen, as far as known from elsewhere [s].
            skewed: Whether the joint's own link encoder may be late beyond that.
            progress: Called with one line a step.
        """
        self.problem, self.delay, self.progress = problem, delay, progress
        # The fit is kept beside its rivals: the ids of its members must not be given to others.
        self._rivals: dict[
            tuple[frozenset[int], float, int], tuple[JointFit, list[tuple[MotionCause, JointFit]]]
        ] = {}
        library = candidates(problem.where, problem.seen(delay))
        self.candidates: list[MotionCause] = [
            *(cause for cause in library if skewed or not cause.of_delay),
            *patterns,
        ]

    def gain(self, before: JointFit, after: JointFit) -> Gain:
        """How much better a model is than another, by the errors of the better one."""
        problem = self.problem
        both = problem.recorded(before.delay) & problem.recorded(after.delay)
        fall = problem.by_block(before.held_out * both) - problem.by_block(after.held_out * both)
        score = float(fall.sum()) / problem.unit(after.held_out, before.residual - after.residual)
        score -= NUMBER * (after.numbers - before.numbers)
        share = float(fall.sum()) / max(problem.cost(after.held_out), 1e-300)
        return Gain(score, gain_in_errors(fall), share)

    def starts(self) -> list[JointFit]:
        """The model in question; what is not late at first sight may be so beside something else."""
        skew = next((cause for cause in self.candidates if cause.of_delay), None)
        return [self.fit(()), *([] if skew is None else [self.fit((skew,))])]

    def fit(self, members: Sequence[MotionCause]) -> JointFit:
        """A model fitted about the delay that it finds itself."""
        return self.problem.settled(members, self.delay)

    def settled(self, model: JointFit) -> JointFit:
        """The same about the delay that it finds itself."""
        return self.problem.settled(model.members, model.delay)

    def told(self, best: JointFit) -> str:
        """The joint and its causes."""
        return f"{self.problem.where}: " + " + ".join(map(repr, best.members))

    def named_only(self, first: Sequence[MotionCause]) -> JointFit:
        """The best model of named causes, from some of them on."""
        best = self.prune(self.fit(first), strictly=True)
        while len(best.members) < self.largest:
            named = [found for found in self.grown([best], None, best) if found.members[-1].named]
            if (grown := self.first_earning(best, named)) is None:
                break
            larger = self.prune(self.settled(grown), strictly=True)
            if self.gain(best, larger).score <= 0.0:
                break
            best = larger
        return best

    def transferred(self, best: JointFit) -> tuple[JointFit, list[MotionCause]]:
        """Drop members that make a recording worse that was left out as a whole.

        Returns:
            The model, and what was dropped; all stay where there is one recording only.
        """
        dropped: list[MotionCause] = []
        while len(self.problem.motions) > 1 and best.members:
            now = self.problem.left_out(best.members, best.delay)
            costs = []
            for cause in best.members:
                smaller = self.without(best, cause)
                costs.append(self.problem.left_out(smaller.members, smaller.delay))
            least = int(ranks(np.array(costs))[0])
            if costs[least] >= now:
                break
            dropped.append(best.members[least])
            best = self.without(best, best.members[least])
        return best, dropped

    def grown(self, beam: Sequence[JointFit], smaller: JointFit | None, best: JointFit) -> list[JointFit]:
        """Every plausible model with one member more, waves that its residual asks for included."""
        offered = self.joining(best, waves=True)
        return [found for cause in offered if (found := self.add(best, cause)) is not None]

    def earns(self, smaller: JointFit, larger: JointFit) -> bool:
        """Whether the last member brings more than chance does."""
        return self.gain(smaller, larger).enough(larger.members[-1])

    def offers(self, model: JointFit, instead: MotionCause) -> list[MotionCause]:
        """Every other candidate; for a wave also those that the residual asks for."""
        found = self.joining(model, isinstance(instead, MotionPeriodicError))
        return [cause for cause in found if cause is not instead]

    def joining(self, best: JointFit, waves: bool) -> list[MotionCause]:
        """What may join a model; with `waves`, also those that its residual asks for."""
        slots = {cause.slot for cause in best.members}
        found = wave_candidates(self.problem, best) if waves else []
        fresh = [wave for wave in found if not any(self._same_wave(wave, other) for other in best.members)]
        return [cause for cause in (*self.candidates, *fresh) if cause.slot not in slots]

    def _same_wave(self, wave: MotionPeriodicError, other: MotionCause) -> bool:
        if not isinstance(other, MotionPeriodicError):
            return False
        seen = self.problem.seen(0.0)[0]
        reach = max(float(np.ptp(motion.motor)) for motion in self.problem.motions)
        return abs(wave.waves(seen) - other.waves(seen)) < np.pi / reach

    def add(self, model: JointFit, cause: MotionCause) -> JointFit | None:
        """A model with one more member, unless a number in it cannot be."""
        found = self.problem.fit((*model.members, cause), model.delay)
        return found if self.problem.plausible(found, strictly=False) else None

    def total(self, found: JointFit) -> float:
        """Held-out error with what its numbers cost, as a share of the squares; smaller is better."""
        return self.problem.cost(found.held_out)

    def ranked(self, models: Iterable[JointFit]) -> list[JointFit]:
        """Models by what they leave, the best first; each number and each shape without a name costs."""
        fits = list(models)
        if not fits:
            return []
        unit = _ALIKE * min(self.total(found) for found in fits) / len(self.problem)

        def score(found: JointFit) -> float:
            shapes = sum(not cause.named for cause in found.members)
            return self.total(found) / unit + NUMBER * found.numbers + PENALTY * shapes

        return ranked(fits, score)

    def without(self, model: JointFit, *causes: MotionCause) -> JointFit:
        """The same model less some members."""
        rest = tuple(other for other in model.members if all(other is not cause for cause in causes))
        return self.problem.settled(rest, self.delay_without(model.delay, *causes))

    def delay_without(self, delay: float, *causes: MotionCause) -> float:
        """At which a model sees the joint less some members, where it is a delay with them [s]."""
        return self.delay if any(cause.of_delay for cause in causes) else delay

    def useless(
        self, model: JointFit, asked: Sequence[MotionCause], strictly: bool
    ) -> list[tuple[MotionCause, float]]:
        """Members that bring no more than chance; all of them where a number cannot be."""
        plausible = self.problem.plausible(model, strictly)
        gains = [(cause, self.gain(self.without(model, cause), model)) for cause in asked]
        return [(cause, gain.score) for cause, gain in gains if not plausible or not gain.enough(cause)]

    def better(self, one: JointFit, other: JointFit) -> bool:
        """Whether the fall is more than rounding."""
        return self.gain(other, one).score > 1.0

    def rivals(self, model: JointFit, cause: MotionCause) -> list[tuple[MotionCause, JointFit]]:
        """Every other candidate in the place of one member that is plausible there."""
        key = (frozenset(map(id, model.members)), model.delay, id(cause))
        if key not in self._rivals:
            self._rivals[key] = (model, super().rivals(model, cause))
        return self._rivals[key][1]

    def other_orders(
        self, model: JointFit, wave: MotionPeriodicError
    ) -> list[tuple[MotionPeriodicError, JointFit]]:
        """The other orders in the place of a member, those that are plausible there."""
        rest = self.without(model, wave)
        taken = {cause.slot for cause in model.members}
        beside = [(other, self.add(rest, other)) for other in neighbours(wave)]
        pairs = [*beside, *self.rivals(model, wave)]
        found = {
            other.slot: (other, fit)
            for other, fit in pairs
            if isinstance(other, MotionPeriodicError) and fit is not None
        }
        return [pair for slot, pair in sorted(found.items()) if slot not in taken]

    def strength(self, found: JointFit, cause: MotionCause) -> float:
        """Least size of a member's coefficients in their standard deviations, by the scatter of the blocks."""
        index = found.members.index(cause)
        if cause.of_delay:
            return _strength(found.x[index] + found.delay - self.delay, found.std[index])
        pairs = [
            (found.x[index], found.std[index]),
            *zip(found.own[index], found.own_std[index], strict=True),
        ]
        if len(found.x[index]):
            pairs = pairs[:1]
        return min((_strength(x, std) for x, std in pairs if len(x)), default=float("inf"))


def _strength(x: FloatArray, std: FloatArray) -> float:
    """Length of some coefficients in their standard deviations."""
    return float(np.sqrt(np.sum((x / np.maximum(std, 1e-300)) ** 2)))
