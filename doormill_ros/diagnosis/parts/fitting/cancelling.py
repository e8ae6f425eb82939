"""Two causes that change at one door and move the points nearly against each other: a softer tool in softer wood, say.

Neither of them gains anything alone, and where a third one that is too small for a name takes what they leave together,
the search stops. Pairs of them are tried in its place.
"""

from __future__ import annotations

from itertools import islice

from doormill_ros.diagnosis.core.searching.beam import ENTRY
from doormill_ros.diagnosis.core.words.verdict import EXPLAINED
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.known import moves_enough
from doormill_ros.diagnosis.parts.fitting.problem import DoorDiagnosis

_TRIED = 8  #: pairs that are fitted


def with_cancelling(found: DoorDiagnosis) -> DoorDiagnosis:
    """What is said with two causes that change at one door in the place of what was refused; else the same.

    Both have to earn their place beside what is named, by more than what was refused does, to move the points together
    by more than the mill is known to, and to leave noise.

    Args:
        found: What is said of the doors.
    """
    search, refused = found.search, [cause for cause, _ in found.examination.refused]
    if not refused:
        return found
    rest = search.without(found.best, *refused)
    together = (pair for pair in search.promising(rest, found.best) if _may_cancel(*pair))
    models = [search.add(search.add(rest, one), other) for one, other in islice(together, _TRIED)]
    limit = min(search.total(found.best) - ENTRY, search.total(rest) - 2.0 * ENTRY)
    earning = [model for model in search.ranked(models) if search.total(model) <= limit]
    if not earning:
        return found
    problem, best = found.problem, search.finished(earning[0])
    before = {cause.identity for cause in rest.members}
    new = [cause for cause in best.members if cause.identity not in before]
    if moves_enough(problem.case, problem.resolution, best.members, best.theta, *new).fails:
        return found
    other = found.saying(best)
    return other if other.verdict == EXPLAINED else found


def _may_cancel(one: InTime, other: InTime) -> bool:
    return (
        one.named
        and other.named
        and one.course.steps
        and other.course.steps
        and one.course.at == other.course.at
    )
