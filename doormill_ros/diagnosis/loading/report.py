"""report.html: one page that shows why a diagnosis should be believed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.document import parameters_of
from doormill_ros.diagnosis.core.margin import margins_table
from doormill_ros.diagnosis.loading import pictures
from doormill_ros.diagnosis.loading.candidates import candidates_table
from doormill_ros.diagnosis.loading.diagnosis import LoadingDiagnosis
from doormill_ros.diagnosis.loading.next_measurement import DECIDED, NextMeasurement
from doormill_ros.diagnosis.loading.path_shift import PathShift
from doormill_ros.diagnosis.wording import (
    micrometres,
    spoken,
    spoken_findings,
    verdict_sentence,
    with_deviation,
)
from doormill_ros.pages.page import Block, Charts, Page, Section, Table, Text, Tiles, render
from doormill_ros.units import m_to_mm, rad_to_deg


def render_report(
    diagnosis: LoadingDiagnosis,
    plan: NextMeasurement,
    checks: Sequence[dict[str, Any]] = (),
    shift: PathShift | None = None,
    margins: Sequence[dict[str, Any]] = (),
) -> str:
    """The page as HTML text without any outside resource."""
    sections = [Section("", [_tiles(diagnosis), Text(diagnosis.remarks, note=True)])]
    if diagnosis.findings:
        sections += [
            Section("Causes", _causes(diagnosis)),
            Section("The pattern that gave it away", _patterns(diagnosis)),
            Section("What it changes on a part", _part(shift)),
        ]
    sections.append(
        Section(
            "Measured against simulated",
            [
                Charts(pictures.before_and_after(diagnosis), "halves"),
                Text(
                    [
                        "Every dot is one axis of one trial; the grey bands, here and below, are twice the noise."
                    ]
                ),
            ],
        )
    )
    nameless = pictures.patterns_without_a_name(diagnosis)
    if nameless:
        title = "What remains looks like this, and no cause leaves it"
        sections.append(Section(title, [Charts(nameless, "wide")]))
    sections += [
        Section("Residual by joint", [Charts(pictures.residual_by_joint(diagnosis))]),
        Section("Residual by load and time", [Charts(pictures.residual_by_circumstance(diagnosis))]),
        Section(
            "Residual by direction, reflector and posture", [Charts(pictures.residual_by_group(diagnosis))]
        ),
        Section("Candidates", candidates_table(diagnosis)),
        Section("What cannot be told apart", _confusable(diagnosis)),
        Section("What to measure next", _next(plan)),
    ]
    if margins:
        sections.append(Section("How close the decisions were", [margins_table(margins)]))
    if diagnosis.outliers:
        listed = ", ".join(map(str, diagnosis.outliers))
        sentence = f"Trials {listed} are gross errors; they steer no fit and count in no figure."
        sections.append(Section("Gross errors", [Text([sentence])]))
    if checks:
        sections.append(Section("Sets that were only predicted", [_checks(checks)]))
    sections.append(Section("How this was found", [Text([_METHOD])]))
    lead = verdict_sentence(diagnosis.verdict, "simulation", "trials", "A cause is established")
    return render(Page(headline(diagnosis), sections, lead))


def headline(diagnosis: LoadingDiagnosis) -> str:
    """The verdict in one line."""
    names = spoken_findings([(finding.cause, *finding.tied) for finding in diagnosis.findings])
    before, after = map(micrometres, diagnosis.holdout_rmse)
    floor = micrometres(diagnosis.problem.noise_floor)
    if diagnosis.verdict == "consistent":
        return f"Consistent: the simulation is off by {before}, the noise is {floor}"
    if diagnosis.verdict == "unexplained":
        return f"Unexplained: the simulation is off by {before} against {floor} of noise"
    word = "Explained" if diagnosis.verdict == "explained" else "Partly explained"
    return f"{word}: {names} ({before} down to {after}, noise {floor})"


def _tiles(diagnosis: LoadingDiagnosis) -> Tiles:
    low, high = diagnosis.ratio_ci
    before, after = map(micrometres, diagnosis.holdout_rmse)
    entries = [
        (before, "simulation now"),
        (micrometres(diagnosis.problem.noise_floor), "measurement noise"),
        (str(len(diagnosis.problem)), f"trials, {len(diagnosis.outliers)} of them gross errors"),
        (str(int(diagnosis.problem.configuration.max()) + 1), "configurations"),
    ]
    if diagnosis.findings:
        entries[1:1] = [
            (after, "extended model on unseen configurations"),
            (
                f"{100 * diagnosis.ratio:.0f} %",
                f"of the residual left (95 %: {100 * low:.0f} to {100 * high:.0f} %)",
            ),
        ]
    return Tiles(entries)


def _patterns(diagnosis: LoadingDiagnosis) -> list[Block]:
    blocks: list[Block] = []
    for finding in diagnosis.findings:
        blocks.append(Text([f"{finding.cause.pattern().capitalize()}."]))
        blocks.append(Charts([pictures.pattern_of(diagnosis, finding)], "wide"))
    return blocks


def _causes(diagnosis: LoadingDiagnosis) -> list[Block]:
    rows = []
    for finding in diagnosis.findings:
        for name, entry in parameters_of(finding).items():
            values, stds = (list(np.atleast_1d(entry[key])) for key in ("value", "std"))
            rows.append(
                [
                    spoken(finding.cause),
                    name.replace("_", " "),
                    with_deviation(values, stds, entry["unit"]),
                    micrometres(finding.without),
                ]
            )
    head = ("Cause", "Parameter", "Value ± standard deviation", "Held-out residual without the cause")
    return [
        Table(head, rows),
        Text(["The true value lies within two standard deviations 95 times of 100."]),
    ]


def _part(shift: PathShift | None) -> list[Block]:
    if shift is None:
        sentence = "Nothing: the causes lie in the measuring chain, and the robot's own model stays as it is."
        return [Text([sentence])]
    rows = [[feature, f"{m_to_mm(away):.3f} mm"] for feature, away in shift.largest.items()]
    table = [Table(("Feature", "Largest shift of a target"), rows)] if rows else []
    return [Text([shift.sentence]), *table]


def _confusable(diagnosis: LoadingDiagnosis) -> list[Block]:
    rows = [
        [
            spoken(finding.cause),
            spoken(equal.cause),
            "nothing: the two are tied" if equal.tied else f"{equal.behind:.1f} of score",
        ]
        for finding in diagnosis.findings
        for equal in finding.equals
    ]
    if not diagnosis.findings:
        return [Text(["No cause is named, so there is none that another could be taken for."])]
    if not rows:
        return [Text(["Every established cause is told apart from all others by these data."])]
    return [Table(("Named", "Would do as well", "What the data say for the first"), rows)]


def _next(plan: NextMeasurement) -> list[Block]:
    if plan.odds < DECIDED:
        return [Text([plan.sentence])]
    rows = [
        [
            str(i + 1),
            ", ".join(f"{a:.1f}" for a in rad_to_deg(t.q)),
            f"{t.force:.0f} N along base {t.load}",
            "forwards" if t.direction > 0 else "backwards",
            t.reflector,
            micrometres(t.difference),
        ]
        for i, t in enumerate(plan.trials)
    ]
    head = (
        "", "Joint angles [deg]", "Load", "Last motion of all joints", "Reflector", "The two models differ by",
    )  # fmt: skip
    return [Text([plan.sentence]), Table(head, rows)]


def _checks(checks: Sequence[dict[str, Any]]) -> Table:
    rows = [
        [
            str(c["set"]),
            str(c["rows"]),
            micrometres(c["baseline"]["rmse"]),
            micrometres(c["extended"]["rmse"]),
        ]
        for c in checks
    ]
    return Table(("Set", "Trials", "Now", "Extended"), rows)


_METHOD = """The simulation turns every joint by torque over stiffness. Its residuals are weighed by the noise of
tracker and force sensor in every trial. Every cause of the library, at every place, was fitted alone and in
combination, by least squares that gross errors cannot steer. Each model was scored on whole configurations left out
of its fit; a cause is named only if it improves that score by far more than chance could with so many candidates, if
shapes that belong to no known cause do not fit as well, and if it says the same in every part of the data. All
residuals called unseen or held-out are of trials that the fit had not seen. Where the direction of a last motion is
not recorded, whether a gap was open in a trial is read from that trial itself."""
