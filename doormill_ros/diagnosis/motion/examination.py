"""Which causes of a joint may be named, and what would do as well."""

from __future__ import annotations

from dataclasses import dataclass, replace

from doormill_ros.diagnosis.core.judgement import MOST_REMAINS
from doormill_ros.diagnosis.core.verdict import AT_NOISE
from doormill_ros.diagnosis.motion.model import JointFit
from doormill_ros.diagnosis.motion.patterns import MotionPattern
from doormill_ros.diagnosis.motion.problem import JointProblem
from doormill_ros.diagnosis.motion.search import ENTRY, EQUAL, JointSearch, slow
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.causes.joint_damping import JointDamping
from doormill_ros.robot_model.motion.causes.time_skew import TimeSkew

#: Drivers of patterns that follow the joint's own torque.
OWN_TORQUE = ("own torque", "torque sign")
#: Share of the excess over the noise that a joint's causes explain together to be named where something remains.
JOINT_PART = 0.8


@dataclass(frozen=True, eq=False)
class JointFinding:
    """What was found in one joint.

    Attributes:
        search: All that was tried, and the problem.
        baseline: Fit of the offsets alone.
        best: The best model, shapes without a name included.
        extended: The model of established causes.
        doubles: Of each member of `extended`, what would do as well, with the score by which it is behind.
        refused: Members of `best` that are not named, with the reason.
    """

    search: JointSearch
    baseline: JointFit
    best: JointFit
    extended: JointFit
    doubles: tuple[tuple[tuple[MotionCause, float], ...], ...]
    refused: tuple[tuple[MotionCause, str], ...]

    @property
    def problem(self) -> JointProblem:
        """The joint made ready."""
        return self.search.problem

    def withdrawn(self) -> JointFinding:
        """The same with no cause named."""
        refused = [*self.refused, *((cause, MOST_REMAINS) for cause in self.extended.members)]
        return replace(self, extended=self.baseline, doubles=(), refused=tuple(refused))


def examined(search: JointSearch, best: JointFit) -> JointFinding:
    """Which members may be named, and what would do as well."""
    problem = search.problem
    baseline = problem.fit(())
    refused: list[tuple[MotionCause, str]] = []
    structure = problem.rmse(best.held_out) > AT_NOISE * problem.floor
    shapes = [other for other in best.members if isinstance(other, MotionPattern)]
    for cause in best.members:
        if not cause.named:
            continue
        if not search.clear(best, cause):
            refused.append((cause, "its size changes too much between the blocks"))
        elif (rival := _shape_instead(search, best, cause)) is not None:
            refused.append((cause, f"{rival!r} explains more"))
            shapes.append(rival)
    if not structure:
        gone = {id(cause) for cause, _ in refused}
        refused += [
            (cause, "a shape without a name beside it says that its law is another")
            for cause in best.members
            if id(cause) not in gone and any(shape.spoils(cause) for shape in shapes)
        ]
    left = {id(cause) for cause, _ in refused}
    named = [cause for cause in best.members if cause.named and id(cause) not in left]
    # Where a shape without a name brings a joint to its noise, causes that would imitate it are not asked for.
    if structure and len(named) < len(best.members):
        wrong = {cause.slot for cause, _ in refused}
        found = search.named_only(named)
        named = [cause for cause in found.members if cause.slot not in wrong and search.clear(found, cause)]
    extended, dropped = search.transferred(problem.settled(named, search.delay))
    refused += [(cause, "it makes a recording worse that was left out") for cause in dropped]
    named = list(extended.members)
    excess = problem.rmse(baseline.held_out) ** 2 - problem.floor**2
    share = (problem.rmse(baseline.held_out) ** 2 - problem.rmse(extended.held_out) ** 2) / max(excess, 1e-30)
    if named and problem.rmse(extended.held_out) > AT_NOISE * problem.floor and share < JOINT_PART:
        refused += [(cause, MOST_REMAINS) for cause in named]
        extended = problem.settled((), search.delay)
    doubles = tuple(_doubles(search, extended, cause) for cause in extended.members)
    return JointFinding(search, baseline, best, extended, doubles, tuple(refused))


def _shape_instead(search: JointSearch, best: JointFit, cause: MotionCause) -> MotionPattern | None:
    """A shape without a name that explains clearly more in the place of a cause.

    In the place of a slow wave it is enough that a law of the joint's torque, which gravity ties to its angle, does as
    well.
    """
    for other, fit in search.rivals(best, cause):
        if not isinstance(other, MotionPattern):
            continue
        least = -EQUAL if slow(cause) and other.driver in OWN_TORQUE else ENTRY
        if search.gain(best, fit).score > least:
            return other
    return None


def _doubles(
    search: JointSearch, found: JointFit, cause: MotionCause
) -> tuple[tuple[MotionCause, float], ...]:
    """Other causes that would do as well in the place of one, each at its best."""
    doubles: dict[tuple[str, str], tuple[MotionCause, float]] = {}
    for other, fit in search.rivals(found, cause):
        behind = search.gain(fit, found).score
        if other.named and other.key != cause.key and behind < EQUAL:
            doubles.setdefault(other.key, (other, behind))
    if isinstance(cause, JointDamping):
        # A lone encoder that is read early: the same but for the acceleration's share, which no recording shows.
        early = TimeSkew(cause.where)
        doubles.setdefault(early.key, (early, 0.0))
    return tuple(doubles.values())
