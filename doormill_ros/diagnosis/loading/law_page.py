"""What the page of a loading test shows of laws without a name: sentence, picture, gain, and what would tell."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.telling.characterised import Characterised, UnnamedLaw
from doormill_ros.diagnosis.core.words.wording import MICRO
from doormill_ros.diagnosis.law.page import TITLE, lead, sentence
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis
from doormill_ros.pages.charts import BLUE, RED, WIDE, Curve, scatter
from doormill_ros.pages.page import Block, Charts, PageSection, Paragraphs
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.law.term import LawTerm
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.units import m_to_um

_SEEN = 0.5  #: motion of the point, over its root mean square, from which an amount is shown


def law_page(diagnosis: LoadingDiagnosis) -> list[PageSection]:
    """One section for all laws; none where there are none."""
    found = diagnosis.characterised
    if found is None:
        return []
    unit = diagnosis.problem.unit
    blocks: list[Block] = [
        lead(
            diagnosis.holdout_rmse[1],
            found.holdout_rmse,
            diagnosis.problem.noise_floor,
            unit,
            "unseen postures",
        )
    ]
    for law in found.laws:
        blocks.append(Paragraphs([sentence(law, unit, "unseen postures")]))
        if isinstance(law.terms[0], LawTerm):
            blocks.append(Charts([_picture(diagnosis, found, law)], "wide"))
    return [PageSection(TITLE, blocks)]


def _picture(
    diagnosis: LoadingDiagnosis, found: Characterised[ElasticCause], law: UnnamedLaw[ElasticCause]
) -> str:
    """What the model without the law leaves, and the law, over what drives it; in amounts of what it acts on."""
    problem, fit = diagnosis.problem, found.fit
    theta = fit.theta.copy()
    for term in law.terms:
        theta[fit.part(term)] = 0.0
    left = problem.predict(fit.members, theta).residual
    effect = left - fit.prediction.residual
    first = law.terms[0]
    assert isinstance(first, LawTerm)
    values, label = _abscissa(problem.case, first, effect)
    motion, unit = effect, "of the law's effect"
    if len(moved := first.carrier.motion(problem.case, law.where)) == 1:
        motion, unit = moved[0][:, :3], f"[{first.carrier.unit}]".replace("[1]", "as a share")
    size = np.sum(motion**2, axis=1)
    # Where what it acts on hardly moves the point, the amount is all noise.
    rows = diagnosis.kept & np.isfinite(values) & (size > _SEEN**2 * np.mean(size))
    shown = np.flatnonzero(rows)[np.argsort(values[rows], kind="stable")]
    dots, line = (np.sum(part * motion, axis=1)[shown] / size[shown] for part in (left, effect))
    return scatter(
        f"{law.where} by {law.driver}: what remains without the law, and the law",
        label,
        f"{law.acts_on} {unit}",
        [Curve("remains", RED, values[shown], dots), Curve("law", BLUE, values[shown], line)],
        width=WIDE,
    )


def _abscissa(case: LoadCase, term: LawTerm, effect: FloatArray) -> tuple[FloatArray, str]:
    """What drives a law's first term, shape (n,), and its label; the size of the effect where that has no unit."""
    unit = term.drives.unit
    if not unit:
        return m_to_um(np.linalg.norm(effect, axis=1)), f"size of the law's effect [{MICRO}m]"
    return term.values_of(case, term.where, term.driver), f"{term.driver} [{unit}]"
