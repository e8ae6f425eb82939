"""report.html: one page that shows why a diagnosis should be believed."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from doormill_ros.diagnosis.loading.diagnosis import Diagnosis
from doormill_ros.diagnosis.loading.document import parameters_of
from doormill_ros.diagnosis.loading.next_measurement import DECIDED, NextMeasurement
from doormill_ros.diagnosis.loading.path_shift import PathShift
from doormill_ros.diagnosis.report import pictures
from doormill_ros.diagnosis.report.candidates import candidates_table
from doormill_ros.diagnosis.report.html import charts, notes, page, section, tiles
from doormill_ros.diagnosis.report.wording import micrometres, spoken, spoken_findings, with_deviation
from doormill_ros.units import rad_to_deg

_SENTENCES = {
    "consistent": "The simulation is right to within the measurement noise. Nothing has to be changed.",
    "explained": "With the extension the model predicts unseen trials down to the measurement noise.",
    "partly_explained": "A cause is established, yet the residual still has structure that no known cause explains.",
    "unexplained": "Something is wrong that is not in the library of causes. No cause is named, because a wrong one is "
    "worse than none.",
}


def render_report(
    diagnosis: Diagnosis,
    plan: NextMeasurement,
    checks: Sequence[dict[str, Any]] = (),
    shift: PathShift | None = None,
) -> str:
    """The page as HTML text without any outside resource."""
    parts = [
        _tiles(diagnosis),
        notes(diagnosis.remarks),
    ]
    if diagnosis.findings:
        parts.append(section("Causes", _causes(diagnosis)))
        parts.append(section("The pattern that gave it away", _patterns(diagnosis)))
        parts.append(section("What it changes on a part", _part(shift)))
    parts.append(
        section(
            "Measured against simulated",
            charts(pictures.before_and_after(diagnosis), "halves")
            + "<p>Every dot is one axis of one trial; the grey bands, here and below, are twice the noise.</p>",
        )
    )
    nameless = pictures.patterns_without_a_name(diagnosis)
    if nameless:
        parts.append(
            section("What remains looks like this, and no cause leaves it", charts(nameless, "wide"))
        )
    parts += [
        section("Residual by joint", charts(pictures.residual_by_joint(diagnosis))),
        section("Residual by load and time", charts(pictures.residual_by_circumstance(diagnosis))),
        section(
            "Residual by direction, reflector and posture", charts(pictures.residual_by_group(diagnosis))
        ),
        section("Candidates", candidates_table(diagnosis)),
        section("What cannot be told apart", _confusable(diagnosis)),
        section("What to measure next", _next(plan)),
    ]
    if diagnosis.outliers:
        listed = ", ".join(map(str, diagnosis.outliers))
        parts.append(
            section(
                "Gross errors",
                f"<p>Trials {listed} are gross errors; they steer no fit and count in no figure.</p>",
            )
        )
    if checks:
        parts.append(section("Sets that were only predicted", _checks(checks)))
    parts.append(section("How this was found", _METHOD))
    return page(headline(diagnosis), _SENTENCES[diagnosis.verdict], parts)


def headline(diagnosis: Diagnosis) -> str:
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


def _tiles(diagnosis: Diagnosis) -> str:
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
    return tiles(entries)


def _patterns(diagnosis: Diagnosis) -> str:
    parts = []
    for finding in diagnosis.findings:
        parts.append(
            f"<p>{escape(finding.cause.pattern().capitalize())}.</p>"
            + pictures.pattern_of(diagnosis, finding)
        )
    return f'<div class="wide">{"".join(parts)}</div>'


def _causes(diagnosis: Diagnosis) -> str:
    rows = []
    for finding in diagnosis.findings:
        for name, entry in parameters_of(finding).items():
            values, stds = (list(np.atleast_1d(entry[key])) for key in ("value", "std"))
            rows.append(
                f"<tr><td>{escape(spoken(finding.cause))}</td><td>{escape(name.replace('_', ' '))}</td>"
                f"<td>{escape(with_deviation(values, stds, entry['unit']))}</td>"
                f"<td>{micrometres(finding.without)}</td></tr>"
            )
    return (
        "<table><tr><th>Cause</th><th>Parameter</th><th>Value &plusmn; standard deviation</th>"
        f"<th>Held-out residual without the cause</th></tr>{''.join(rows)}</table>"
        "<p>The true value lies within two standard deviations 95 times of 100.</p>"
    )


def _part(shift: PathShift | None) -> str:
    if shift is None:
        return (
            "<p>Nothing: the causes lie in the measuring chain, and the robot's own model stays as it is.</p>"
        )
    rows = "".join(
        f"<tr><td>{escape(feature)}</td><td>{1e3 * away:.3f} mm</td></tr>"
        for feature, away in shift.largest.items()
    )
    table = (
        f"<table><tr><th>Feature</th><th>Largest shift of a target</th></tr>{rows}</table>" if rows else ""
    )
    return f"<p>{escape(shift.sentence)}</p>{table}"


def _confusable(diagnosis: Diagnosis) -> str:
    rows = [
        f"<tr><td>{escape(spoken(f.cause))}</td><td>{escape(', '.join(map(spoken, f.confusable)))}</td></tr>"
        for f in diagnosis.findings
        if f.confusable
    ]
    if not diagnosis.findings:
        return "<p>No cause is named, so there is none that another could be taken for.</p>"
    if not rows:
        return "<p>Every established cause is told apart from all others by these data.</p>"
    return f"<table><tr><th>Named</th><th>Would do as well</th></tr>{''.join(rows)}</table>"


def _next(plan: NextMeasurement) -> str:
    rows = [
        f"<tr><td>{i + 1}</td><td>{', '.join(f'{a:.1f}' for a in rad_to_deg(t.q))}</td><td>{t.force:.0f} N along base "
        f"{escape(t.load)}</td><td>{'forwards' if t.direction > 0 else 'backwards'}</td><td>{escape(t.reflector)}</td>"
        f"<td>{micrometres(t.difference)}</td></tr>"
        for i, t in enumerate(plan.trials)
    ]
    table = (
        "<table><tr><th></th><th>Joint angles [deg]</th><th>Load</th><th>Last motion of all joints</th>"
        f"<th>Reflector</th><th>The two models differ by</th></tr>{''.join(rows)}</table>"
    )
    return f"<p>{escape(plan.sentence)}</p>{table if plan.odds >= DECIDED else ''}"


def _checks(checks: Sequence[dict[str, Any]]) -> str:
    rows = [
        f"<tr><td>{escape(str(c['set']))}</td><td>{c['rows']}</td><td>{micrometres(c['baseline']['rmse'])}</td>"
        f"<td>{micrometres(c['extended']['rmse'])}</td></tr>"
        for c in checks
    ]
    return f"<table><tr><th>Set</th><th>Trials</th><th>Now</th><th>Extended</th></tr>{''.join(rows)}</table>"


_METHOD = """<p>The simulation turns every joint by torque over stiffness. Its residuals are weighed by the noise of
tracker and force sensor in every trial. Every cause of the library, at every place, was fitted alone and in
combination, by least squares that gross errors cannot steer. Each model was scored on whole configurations left out
of its fit; a cause is named only if it improves that score by far more than chance could with so many candidates, if
shapes that belong to no known cause do not fit as well, and if it says the same in every part of the data. All
residuals called unseen or held-out are of trials that the fit had not seen. Where the direction of a last motion is
not recorded, whether a gap was open in a trial is read from that trial itself.</p>"""
