"""What the members of a model that was fitted by robust least squares have to stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic

import numpy as np

from doormill_ros.diagnosis.core.examining.confusable import equals
from doormill_ros.diagnosis.core.examining.examination import Double, Examiner
from doormill_ros.diagnosis.core.examining.stability import (
    CLUSTERED,
    beaten,
    clustering,
    instability,
    same,
    unevenness,
)
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C, Examined
from doormill_ros.diagnosis.core.fitting.robust import gross_errors
from doormill_ros.diagnosis.core.searching.beam import ENTRY, EQUAL, BeamSearch
from doormill_ros.diagnosis.core.words.margin import Check, Margin
from doormill_ros.distributions import chi2_sf

#: Chance of an innocent residual below which structure remains.
STRUCTURE = 1e-4
#: Chance of a stable cause below which it is not believed when structure remains.
UNSTABLE = 1e-3
#: The same when nothing else is left over.
WILD = 1e-4
#: Share of a cause by which the halves may differ when its effect is so strong that everything shows.
WILD_APART = 0.1
#: Share of the excess over the noise that a cause must explain when structure remains.
MAIN_PART = 0.3
_OTHERS = "others would do as well"


class FitExaminer(Examiner[C, Fit[C]], Generic[C]):
    """All models of one problem, and what the problem says of their members.

    Attributes:
        models: The search that tried them.
        beside_laws: Whether laws without a name were found before that leave no more than noise: then a small part is
            as sure as a large one, yet no check is spared.
    """

    models: BeamSearch[C]
    equal = EQUAL

    def __init__(self, problem: Examined[C], models: BeamSearch[C], beside_laws: bool = False) -> None:
        """Keep them."""
        self.problem, self.models, self.beside_laws = problem, models, beside_laws

    def baseline(self) -> Fit[C]:
        """No cause at all."""
        return self.models.fit(())

    def noise(self, model: Fit[C]) -> Sequence[Check]:
        """The size of the residual, and whether what looks like gross errors is an effect."""
        gross = gross_errors(model.prediction.cost, self.problem.components)
        return [
            Check(chance < limit, margins=(Margin(decision, chance, limit, "probability"),))
            for decision, chance, limit in (
                ("something is left over", excess_probability(model, self.problem.components), STRUCTURE),
                ("gross errors sit together", clustering(self.problem, gross), CLUSTERED),
                (
                    "gross errors point along one joint",
                    self.problem.turning(model.prediction.white, gross)[1],
                    CLUSTERED,
                ),
            )
        ]

    def checks(self, best: Fit[C], cause: C, remains: bool) -> Sequence[Check]:
        """The same in all parts of the data; where something remains also a part of its own that no shape explains."""
        strict = self.beside_laws or remains or not all(_believable(best, member) for member in best.members)
        sizes = [*self.problem.objections(best.members, best.theta, cause), *self._sizes(best, cause, strict)]
        if not _believable(best, cause):
            return [*sizes, Check(True, _OTHERS)]
        if not strict:
            return sizes
        empty, models = self.baseline(), self.models
        floor = float(self.problem.components * len(self.problem))
        excess = max(empty.held_out_score - floor, 1.0)
        share = (models.without(best, cause).held_out_score - best.held_out_score) / excess
        shapes = any(
            models.total(found) < models.total(best) + ENTRY or not beaten(self.problem, best, found)
            for other, found in models.rivals(best, cause)
            if not other.named and not (other.same_as == cause.key and same(best, found))
        )
        least = 0.0 if self.beside_laws else MAIN_PART
        explained = Margin(f"{cause!r} explains a share of what is wrong", share, least, "share")
        return [*sizes, Check(share <= least, _OTHERS, (explained,)), Check(shapes, _OTHERS)]

    def _sizes(self, best: Fit[C], cause: C, strict: bool) -> list[Check]:
        """Whether the parts of the data agree about a cause; unless strict, strong effects may differ a little."""
        limit = UNSTABLE if strict else WILD
        halves, where, apart = instability(self.problem, best, cause)
        uneven, scatter = unevenness(self.problem, best, cause, best.weights)
        return [
            Check(
                chance <= limit and (strict or share > WILD_APART),
                against,
                (
                    Margin(f"{cause!r} is the same in {parts}", chance, limit, "probability"),
                    Margin(f"{cause!r} differs between {between} by a share", share, WILD_APART, "share"),
                ),
            )
            for parts, between, chance, share, against in (
                ("both halves", "the halves", halves, apart, f"it has another size in the halves by {where}"),
                (
                    "all configurations",
                    "the configurations",
                    uneven,
                    scatter,
                    "its size changes from configuration to configuration",
                ),
            )
        ]

    def settled(
        self, best: Fit[C], named: Sequence[C], refused: Sequence[tuple[C, str]], remains: bool
    ) -> tuple[Fit[C], Fit[C], Sequence[tuple[C, str]]]:
        """Fitted from where the best model has them."""
        theta = np.concatenate([np.zeros(0)] + [best.theta[best.part(cause)] for cause in named])
        return best, self.models.fit(named, [theta]), ()

    def worth(self, asked: Fit[C]) -> Sequence[Margin]:
        """Scores: what the model loses without a member, and gains by a further one."""
        models = self.models
        total = models.total(asked)
        found = [
            Margin(
                f"{cause!r} stays", models.total(models.without(asked, cause)) - total, ENTRY / 2.0, "score"
            )
            for cause in asked.members
        ]
        further = [models.total(fit) for fit in models.fits.values() if len(fit.members) > len(asked.members)]
        if further:
            found.append(Margin("a further cause enters", total - min(further), ENTRY, "score"))
        return found

    def behind(self, model: Fit[C], rival: Fit[C]) -> float:
        """By the held-out scores with what the numbers cost."""
        return self.models.total(rival) - self.models.total(model)

    def doubles(self, asked: Fit[C], cause: C) -> Sequence[Double[C, Fit[C]]]:
        """Causes, and pairs of them, whose models are equally good."""
        return equals(self.models, asked, cause, self.remains(asked), self.problem.resolution)


def _believable(best: Fit[C], cause: C) -> bool:
    """Whether a member has a name, lies within its range, and no shape beside it says that its law is another."""
    return (
        cause.named
        and not implausible(best, cause)
        and not any(other.spoils(cause) for other in best.members if not other.named)
    )


def implausible(found: Fit[C], cause: C) -> bool:
    """Whether a cause was pushed to the end of its range, where it only imitates something else."""
    theta = found.theta[found.part(cause)]
    low = (theta < 0.98 * cause.lower) & (cause.lower < 0.0)
    high = theta > 0.98 * cause.upper
    return bool(np.any(low | high))


def excess_probability(found: Fit[C], components: int = 3) -> float:
    """Chance that noise alone leaves a residual as large as this."""
    kept = found.weights > 0.0
    freedom = max(components * int(kept.sum()) - int(found.free.sum()), 1)
    return chi2_sf(np.sum(found.prediction.white[kept] ** 2), freedom)
