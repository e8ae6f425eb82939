"""How far each decision of a diagnosis was from its threshold."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.beam import ENTRY, EQUAL
from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.examination import (
    STRUCTURE,
    UNSTABLE,
    WILD,
    WILD_APART,
    excess_probability,
)
from doormill_ros.diagnosis.core.margin import Margin
from doormill_ros.diagnosis.core.stability import CLUSTERED, clustering, instability, unevenness


def margins(diagnosis: Diagnosis[Any, Any]) -> list[Margin]:
    """Every decision with what it was taken by."""
    problem, best = diagnosis.problem, diagnosis.best
    found = _scores(diagnosis)
    gross = ~diagnosis.kept
    chances = [
        ("something is left over", excess_probability(best, problem.components), STRUCTURE),
        ("gross errors sit together", clustering(problem, gross), CLUSTERED),
        ("gross errors point along one joint", problem.turning(best.prediction.white, gross)[1], CLUSTERED),
    ]
    found += [Margin(decision, value, limit, "probability") for decision, value, limit in chances]
    for cause in best.members:
        if not cause.named:
            continue
        halves, _, apart = instability(problem, best, cause)
        uneven, scatter = unevenness(problem, best, cause, best.weights)
        # Where something is left over a cause has to be steady, else it must not be wild.
        limit = WILD if diagnosis.verdict == "explained" else UNSTABLE
        for words, value, threshold, quantity in (
            ("is the same in both halves", halves, limit, "probability"),
            ("differs between the halves by a share", apart, WILD_APART, "share"),
            ("is the same in all configurations", uneven, limit, "probability"),
            ("differs between the configurations by a share", scatter, WILD_APART, "share"),
        ):
            found.append(Margin(f"{cause!r} {words}", value, threshold, quantity))
    return found


def _scores(diagnosis: Diagnosis[Any, Any]) -> list[Margin]:
    """Scores: what each member gains, what a further one would, and how far the next model of the same size is."""
    search, best = diagnosis.search, diagnosis.best
    total = search.total(best)
    found = [
        Margin(f"{cause!r} stays", search.total(search.without(best, cause)) - total, ENTRY / 2.0, "score")
        for cause in best.members
    ]
    further = [search.total(fit) for fit in search.fits.values() if len(fit.members) > len(best.members)]
    if further:
        found.append(Margin("a further cause enters", total - min(further), ENTRY, "score"))
    for finding in diagnosis.findings:
        equal = {cause.key for cause in (finding.cause, *finding.confusable)}
        behind = [
            search.total(fit) - total
            for other, fit in search.rivals(best, finding.cause)
            if other.key not in equal
        ]
        if behind:
            found.append(Margin(f"another cause in place of {finding.cause!r}", min(behind), EQUAL, "score"))
    return [margin for margin in found if np.isfinite(margin.value)]
