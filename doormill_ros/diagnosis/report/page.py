"""report.html: one page that shows why a diagnosis should be believed."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from doormill_ros.diagnosis.diagnosis import Diagnosis
from doormill_ros.diagnosis.document import parameters_of
from doormill_ros.diagnosis.next_measurement import NextMeasurement
from doormill_ros.diagnosis.report import pictures
from doormill_ros.units import rad_to_deg

_STYLE = """
:root{color-scheme:light}body{font:15px/1.5 system-ui,sans-serif;color:#1d2327;background:#f6f7f8;margin:0}
main{max-width:1180px;margin:auto;padding:24px}h1{font-size:24px;margin:0 0 4px}h2{font-size:18px;margin:34px 0 8px}
.tiles{display:flex;flex-wrap:wrap;gap:12px;margin:16px 0}
.tile{background:#fff;border:1px solid #dcdfe3;border-radius:6px;padding:10px 16px;min-width:130px}
.tile b{display:block;font-size:22px}
.charts{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(340px,1fr))}.wide{display:grid;gap:12px}
svg{background:#fff;border:1px solid #dcdfe3;border-radius:6px;width:100%;height:auto}
svg .t{font:600 13px system-ui}svg .l{font:11.5px system-ui}svg .n{font:11px system-ui;fill:#555}
svg .g{stroke:#e6e9ec;stroke-width:1}
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


def render_report(diagnosis: Diagnosis, plan: NextMeasurement, checks: Sequence[dict[str, Any]] = ()) -> str:
    """The page as HTML text without any outside resource."""
    title = headline(diagnosis)
    parts = [
        f'<h1>{escape(title)}</h1><p class="lead">{escape(_SENTENCES[diagnosis.verdict])}</p>',
        _tiles(diagnosis),
        "".join(f'<p class="note">{escape(line)}</p>' for line in diagnosis.remarks),
        _section("Measured against simulated", _charts(pictures.before_and_after(diagnosis))),
    ]
    if diagnosis.findings:
        parts.append(_section("The pattern that gave it away", _patterns(diagnosis)))
        parts.append(_section("Causes", _causes(diagnosis)))
    parts += [
        _section("Residual by joint", _charts(pictures.residual_by_joint(diagnosis))),
        _section("Residual by load and time", _charts(pictures.residual_by_circumstance(diagnosis))),
        _section(
            "Residual by direction, reflector and posture", _wide(pictures.residual_by_group(diagnosis))
        ),
        _section("Candidates", _wide([pictures.candidates_chart(diagnosis)])),
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
    names = " and ".join(f"{f.cause.name.replace('_', ' ')}, {f.cause.where}" for f in diagnosis.findings)
    before, after = (1e6 * value for value in diagnosis.holdout_rmse)
    floor = 1e6 * diagnosis.problem.noise_floor
    if diagnosis.verdict == "consistent":
        return f"Consistent: the simulation is off by {before:.1f} um, the noise is {floor:.1f} um"
    if diagnosis.verdict == "unexplained":
        return f"Unexplained: the simulation is off by {before:.1f} um against {floor:.1f} um of noise"
    word = "Explained" if diagnosis.verdict == "explained" else "Partly explained"
    return f"{word}: {names} ({before:.1f} um down to {after:.1f} um, noise {floor:.1f} um)"


def _section(title: str, body: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{body}</section>"


def _charts(charts: Sequence[str]) -> str:
    return f'<div class="charts">{"".join(charts)}</div>'


def _wide(charts: Sequence[str]) -> str:
    return f'<div class="wide">{"".join(charts)}</div>'


def _tiles(diagnosis: Diagnosis) -> str:
    low, high = diagnosis.ratio_ci
    tiles = [
        (f"{1e6 * diagnosis.holdout_rmse[0]:.1f} um", "simulation now"),
        (f"{1e6 * diagnosis.holdout_rmse[1]:.1f} um", "extended model, unseen data"),
        (f"{1e6 * diagnosis.problem.noise_floor:.1f} um", "measurement noise"),
        (f"{diagnosis.ratio:.2f}", f"residual left (95 %: {low:.2f} to {high:.2f})"),
        (str(len(diagnosis.problem)), f"trials, {len(diagnosis.outliers)} gross errors"),
        (str(int(diagnosis.problem.configuration.max()) + 1), "configurations"),
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
            value, std = _figure(entry["value"]), _figure(entry["std"])
            rows.append(
                f"<tr><td>{escape(finding.cause.name)}</td><td>{escape(finding.cause.where)}</td><td>{escape(name)}</td>"
                f"<td>{value} &plusmn; {std} {escape(entry['unit'])}</td><td>{1e6 * finding.without:.1f} um</td></tr>"
            )
    return (
        "<table><tr><th>Cause</th><th>Where</th><th>Parameter</th><th>Value &plusmn; standard deviation</th>"
        f"<th>Held-out residual without it</th></tr>{''.join(rows)}</table>"
    )


def _figure(value: float | list[float]) -> str:
    if isinstance(value, list):
        return "(" + ", ".join(f"{v:.3g}" for v in value) + ")"
    return f"{value:.4g}"


def _confusable(diagnosis: Diagnosis) -> str:
    rows = [
        f"<tr><td>{escape(repr(f.cause))}</td><td>{escape(', '.join(map(repr, f.confusable)))}</td></tr>"
        for f in diagnosis.findings
        if f.confusable
    ]
    if not rows:
        return "<p>Every established cause is told apart from all others by these data.</p>"
    return f"<table><tr><th>Named</th><th>Would do as well</th></tr>{''.join(rows)}</table>"


def _next(plan: NextMeasurement) -> str:
    rows = [
        f"<tr><td>{i + 1}</td><td>{', '.join(f'{a:.1f}' for a in rad_to_deg(t.q))}</td><td>{t.force:.0f} N along base "
        f"{escape(t.load)}</td><td>{'forwards' if t.direction > 0 else 'backwards'}</td><td>{escape(t.reflector)}</td>"
        f"<td>{1e6 * t.difference:.0f} um</td></tr>"
        for i, t in enumerate(plan.trials)
    ]
    table = (
        "<table><tr><th></th><th>Joint angles [deg]</th><th>Load</th><th>Last motion of all joints</th>"
        f"<th>Reflector</th><th>The two models differ by</th></tr>{''.join(rows)}</table>"
    )
    return f"<p>{escape(plan.sentence)}</p>{table if rows else ''}"


def _checks(checks: Sequence[dict[str, Any]]) -> str:
    rows = [
        f"<tr><td>{escape(str(c['set']))}</td><td>{c['rows']}</td><td>{1e6 * c['baseline']['rmse']:.1f} um</td>"
        f"<td>{1e6 * c['extended']['rmse']:.1f} um</td></tr>"
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
