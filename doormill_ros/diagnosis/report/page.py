"""report.html: one page that shows why a diagnosis should be believed."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from doormill_ros.diagnosis.diagnosis import Diagnosis
from doormill_ros.diagnosis.document import parameters_of
from doormill_ros.diagnosis.next_measurement import DECIDED, NextMeasurement
from doormill_ros.diagnosis.path_shift import PathShift
from doormill_ros.diagnosis.report import pictures
from doormill_ros.diagnosis.report.candidates import candidates_table
from doormill_ros.diagnosis.report.wording import micrometres, spoken, spoken_all, with_deviation
from doormill_ros.units import rad_to_deg

_STYLE = """
:root{color-scheme:light}body{font:15px/1.5 system-ui,sans-serif;color:#1d2327;background:#f6f7f8;margin:0}
main{max-width:1180px;margin:auto;padding:24px}h1{font-size:24px;margin:0 0 4px}h2{font-size:18px;margin:34px 0 8px}
.tiles{display:flex;flex-wrap:wrap;gap:10px;margin:16px 0}
.tile{background:#fff;border:1px solid #dcdfe3;border-radius:6px;padding:8px 13px;flex:1 1 120px;font-size:13.5px}
.tile b{display:block;font-size:21px;white-space:nowrap}
.charts{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(340px,1fr));align-items:start}
.halves{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(480px,1fr))}.wide{display:grid;gap:12px}
.models td:nth-child(2){width:20%}.models td:nth-child(3){width:34%}
.bar{height:5px;margin-top:2px}.own td{font-weight:600}
svg{background:#fff;border:1px solid #dcdfe3;border-radius:6px;width:100%;height:auto}
svg .t{font:600 13px system-ui}svg .l{font:11.5px system-ui}svg .n{font:11px system-ui;fill:#555}
svg .g{stroke:#e6e9ec;stroke-width:1}svg .h{paint-order:stroke;stroke:#fff;stroke-width:3px}
table{border-collapse:collapse;background:#fff;width:100%}
td,th{border:1px solid #dcdfe3;padding:5px 9px;text-align:left;vertical-align:top}th{background:#eef0f2}
.lead{font-size:17px}.note{color:#555}
"""

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
    title = headline(diagnosis)
    parts = [
        f'<h1>{escape(title)}</h1><p class="lead">{escape(_SENTENCES[diagnosis.verdict])}</p>',
        _tiles(diagnosis),
        "".join(f'<p class="note">{escape(line)}</p>' for line in diagnosis.remarks),
    ]
    if diagnosis.findings:
        parts.append(_section("Causes", _causes(diagnosis)))
        parts.append(_section("The pattern that gave it away", _patterns(diagnosis)))
        parts.append(_section("What it changes on a part", _part(shift)))
    parts.append(
        _section(
            "Measured against simulated",
            _charts(pictures.before_and_after(diagnosis), "halves")
            + "<p>Every dot is one axis of one trial; the grey bands, here and below, are twice the noise.</p>",
        )
    )
    nameless = pictures.patterns_without_a_name(diagnosis)
    if nameless:
        parts.append(_section("What remains looks like this, and no cause leaves it", _wide(nameless)))
    parts += [
        _section("Residual by joint", _charts(pictures.residual_by_joint(diagnosis))),
        _section("Residual by load and time", _charts(pictures.residual_by_circumstance(diagnosis))),
        _section(
            "Residual by direction, reflector and posture", _charts(pictures.residual_by_group(diagnosis))
        ),
        _section("Candidates", candidates_table(diagnosis)),
        _section("What cannot be told apart", _confusable(diagnosis)),
        _section("What to measure next", _next(plan)),
    ]
    if diagnosis.outliers:
        listed = ", ".join(map(str, diagnosis.outliers))
        parts.append(
            _section(
                "Gross errors",
                f"<p>Trials {listed} are gross errors; they steer no fit and count in no figure.</p>",
            )
        )
    if checks:
        parts.append(_section("Sets that were only predicted", _checks(checks)))
    parts.append(_section("How this was found", _METHOD))
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
        f'content="width=device-width,initial-scale=1"><title>{escape(title)}</title><style>{_STYLE}</style></head>'
        f"<body><main>{''.join(parts)}</main></body></html>\n"
    )


def headline(diagnosis: Diagnosis) -> str:
    """The verdict in one line."""
    names = spoken_all([finding.cause for finding in diagnosis.findings])
    before, after = map(micrometres, diagnosis.holdout_rmse)
    floor = micrometres(diagnosis.problem.noise_floor)
    if diagnosis.verdict == "consistent":
        return f"Consistent: the simulation is off by {before}, the noise is {floor}"
    if diagnosis.verdict == "unexplained":
        return f"Unexplained: the simulation is off by {before} against {floor} of noise"
    word = "Explained" if diagnosis.verdict == "explained" else "Partly explained"
    return f"{word}: {names} ({before} down to {after}, noise {floor})"


def _section(title: str, body: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{body}</section>"


def _charts(charts: Sequence[str], layout: str = "charts") -> str:
    return f'<div class="{layout}">{"".join(charts)}</div>'


def _wide(charts: Sequence[str]) -> str:
    return _charts(charts, "wide")


def _tiles(diagnosis: Diagnosis) -> str:
    low, high = diagnosis.ratio_ci
    before, after = map(micrometres, diagnosis.holdout_rmse)
    tiles = [
        (before, "simulation now"),
        (micrometres(diagnosis.problem.noise_floor), "measurement noise"),
        (str(len(diagnosis.problem)), f"trials, {len(diagnosis.outliers)} of them gross errors"),
        (str(int(diagnosis.problem.configuration.max()) + 1), "configurations"),
    ]
    if diagnosis.findings:
        tiles[1:1] = [
            (after, "extended model on unseen configurations"),
            (
                f"{100 * diagnosis.ratio:.0f} %",
                f"of the residual left (95 %: {100 * low:.0f} to {100 * high:.0f} %)",
            ),
        ]
    body = "".join(f'<div class="tile"><b>{escape(a)}</b>{escape(b)}</div>' for a, b in tiles)
    return f'<div class="tiles">{body}</div>'


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
