"""What a page shows of laws without a name: sentence, picture, gain, and what would tell."""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.telling.characterised import Characterised, UnnamedLaw
from doormill_ros.diagnosis.core.words.wording import Unit
from doormill_ros.diagnosis.law.linear import LinearProblem
from doormill_ros.pages.charts import BLUE, RED, WIDE, Curve, scatter
from doormill_ros.pages.page import Block, Charts, Paragraphs
from doormill_ros.robot_model.law.term import Term

_POINTS = 1500  #: of a cloud
TITLE = "A law without a name"


def sentence(law: UnnamedLaw[Any], unit: Unit, unseen: str) -> str:
    """The law, what it gains on what was left out, its rivals, and what would tell what it is."""
    rivals = " or ".join(f"{rival.driver} at {rival.where}" for rival in law.rivals)
    also = f" Nearly as well would do {rivals}." if rivals else ""
    return (
        f"{law.law[0].upper()}{law.law[1:]}. Without it {unseen} are off by {unit.spoken(law.without)}.{also} "
        f"To tell what it is: {law.test}."
    )


def lead(before: float, after: float, floor: float, unit: Unit, unseen: str) -> Paragraphs:
    """What all laws together gain, held-out RMSE before and after and the noise."""
    figures = f"{unit.spoken(before)} down to {unit.spoken(after)}, noise {unit.spoken(floor)}"
    return Paragraphs(
        [
            f"No cause explains what remains, so nothing more is named. What follows predicts {unseen} all the same: "
            f"{figures}."
        ]
    )


def picture(found: Characterised[Any], law: UnnamedLaw[Any], unit: Unit) -> Block:
    """What a linear model leaves without a law, and the law, along the way that it goes, over what drives it."""
    problem, fit = found.problem, found.fit
    assert isinstance(problem, LinearProblem)
    effect = sum(problem.effect(term) @ fit.theta[fit.part(term)] for term in law.terms)
    left = problem.measured_part(fit.prediction.white + effect / problem.sigma)
    way = problem.measured_part(effect / problem.sigma)
    size = np.linalg.norm(way, axis=1)
    along = way / np.maximum(size, 1e-300)[:, None]
    # The sign of the strongest component stands for that of the whole.
    sign = np.sign(way[:, int(np.argmax(np.sum(way**2, axis=0)))])
    dots, line = sign * np.sum(left * along, axis=1), sign * size
    term = law.terms[0]
    assert isinstance(term, Term)
    values = problem.of_rows(term.values_of(problem.case, term.where, term.driver))
    rows = np.flatnonzero(np.isfinite(values))
    rows = rows[:: -(-len(rows) // _POINTS)]
    rows = rows[np.argsort(values[rows], kind="stable")]
    label = f"{law.driver} [{term.drives.unit}]" if term.drives.unit else law.driver
    dots, line = dots[rows] / unit.size, line[rows] / unit.size
    return Charts(
        [
            scatter(
                f"{law.where} by {law.driver}: what remains without the law, and the law",
                label,
                f"{law.acts_on}: effect [{unit.told}]",
                [Curve("remains", RED, values[rows], dots), Curve("law", BLUE, values[rows], line)],
                width=WIDE,
            )
        ],
        "wide",
    )
