"""report.html of a pose diagnosis: one page without anything from outside."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.margin import margins_table
from doormill_ros.diagnosis.pose import pictures
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.wording import verdict_sentence
from doormill_ros.pages.page import Charts, Page, Section, Table, Text, Tiles, render
from doormill_ros.units import rad_to_deg


def render_report(diagnosis: PoseDiagnosis, document: dict[str, Any]) -> str:
    """The page as HTML text."""
    sections = [
        Section("", [_tiles(document), Text(document["remarks"], note=True)]),
        Section("Every series", [_series(document)]),
        Section("Position error before and after", [Charts(pictures.before_and_after(diagnosis))]),
    ]
    curves = pictures.joint_curves(diagnosis)
    if curves:
        title = "The pattern that gave it away: each joint against its own angle"
        sections.append(Section(title, [Text([_CURVES]), Charts(curves, "halves")]))
    within, rejected = document["only_within_one_series"], document["rejected"]
    sections += [
        Section("Causes", [_causes(document)]),
        Section("Candidates on rows left out", [Charts([pictures.candidates_chart(diagnosis)], "wide")]),
        Section("What only helps within one series", [_rejected(within, diagnosis)]),
        Section("What does not help", [_rejected(rejected, diagnosis)]),
        Section("Amplitudes by order", [Charts(pictures.spectra(diagnosis))]),
        Section("What no pose can tell from the placement", [_gauge(document)]),
        Section("Course of the recording", [Charts(pictures.over_rows(diagnosis))]),
        Section("Joint angles that were visited", [_coverage(document)]),
        Section("What to measure next", [Text([document["next_measurement"]]), *_next(document)]),
    ]
    if document["outliers_by_set"]:
        listed = "; ".join(
            f"{name}: {', '.join(map(str, rows))}" for name, rows in document["outliers_by_set"].items()
        )
        sentence = f"Rows {listed}. They steer no fit and count in no figure."
        sections.append(Section("Gross errors", [Text([sentence])]))
    if document.get("margins"):
        sections.append(Section("How close the decisions were", [margins_table(document["margins"])]))
    if document["checks"]:
        sections.append(Section("Sets that were only predicted", [_checks(document)]))
    sources = dict.fromkeys(data.source for data in diagnosis.sets if data.source)
    if sources:
        sections.append(Section("Data", [Text(list(sources))]))
    sections.append(Section("How this was found", [Text([_METHOD])]))
    lead = verdict_sentence(diagnosis.verdict, "nominal model", "poses", "Causes are established")
    return render(Page(_headline(diagnosis, document), sections, lead))


def _headline(diagnosis: PoseDiagnosis, document: dict[str, Any]) -> str:
    before, after = (1e6 * document[name]["holdout_rmse"] for name in ("baseline", "extended"))
    floor = 1e6 * diagnosis.noise_floor
    robot = diagnosis.sets[0].robot
    if diagnosis.verdict == "consistent":
        return f"Consistent: the model of {robot} is off by {before:.0f} um, the noise is {floor:.0f} um"
    if diagnosis.verdict == "unexplained":
        return f"Unexplained: the model of {robot} is off by {before:.0f} um against {floor:.0f} um of noise"
    word = "Explained" if diagnosis.verdict == "explained" else "Partly explained"
    names = ", ".join(dict.fromkeys(s.cause.name.replace("_", " ") for s in diagnosis.established))
    return f"{word}: {robot}, {names} ({before:.0f} um down to {after:.0f} um, noise {floor:.0f} um)"


def _tiles(document: dict[str, Any]) -> Tiles:
    low, high = document["gain"]["ci95"]
    entries = [
        (f"{1e6 * document['baseline']['holdout_rmse']:.0f} um", "nominal model"),
        (f"{1e6 * document['extended']['holdout_rmse']:.0f} um", "extended, blocks left out"),
        (f"{1e6 * document['noise_floor']:.0f} um", "measurement noise"),
        (f"{document['gain']['holdout_rmse_ratio']:.2f}", f"error left (95 %: {low:.2f} to {high:.2f})"),
        (str(sum(s["rows"] for s in document["sets"])), f"poses, {len(document['outliers'])} gross errors"),
    ]
    if "series_out_rmse" in document["extended"]:
        entries.insert(
            2, (f"{1e6 * document['extended']['series_out_rmse']:.0f} um", "extended, series left out")
        )
    return Tiles(entries)


def _um(entry: dict[str, Any], key: str) -> str:
    return f"{1e6 * entry[key]:.0f}" if key in entry else "-"


def _series(document: dict[str, Any]) -> Table:
    rows = []
    for one in document["sets"]:
        base, ext = one["baseline"], one["extended"]
        rows.append(
            [
                one["set"],
                str(one["rows"]),
                str(one["gross_errors"]),
                _um(base, "holdout_rmse"),
                _um(ext, "train_rmse"),
                _um(ext, "holdout_rmse"),
                _um(ext, "series_out_rmse"),
                f"{_um(base, 'rotation_rmse')} / {_um(ext, 'rotation_rmse')}",
            ]
        )
    head = (
        "Series", "Poses", "Gross errors", "Nominal [um]", "Extended, fitted rows", "Blocks left out",
        "Series left out", "Rotation before / after [urad]",
    )  # fmt: skip
    return Table(head, rows)


def _causes(document: dict[str, Any]) -> Table:
    rows = []
    for cause in document["causes"]:
        listed = sorted(cause["parameters"].items(), key=lambda item: -_size(item[1]["value"]))
        text = "; ".join(
            f"{n} {_figure(p['value'])} ± {_figure(p['std'])} {p['unit']}" for n, p in listed[:6]
        )
        more = f"; and {len(listed) - 6} more" if len(listed) > 6 else ""
        confusable = ", ".join(f"{c['cause']} at {c['where']}" for c in cause["confusable_with"])
        rows.append(
            [
                cause["cause"],
                cause["where"],
                text + more,
                f"{1e6 * cause['holdout_rmse_without']:.0f} um",
                confusable,
            ]
        )
    head = ("Cause", "Where", "Parameters ± standard deviation", "Held-out error without it", "Leans on")
    return Table(head, rows)


def _figure(value: Any, digits: int = 3, most: int = 12) -> str:
    """A number, or several in brackets."""
    if isinstance(value, list):
        return "(" + ", ".join(f"{v:.{digits}g}" for v in value[:most]) + ")"
    return f"{value:.{digits}g}"


def _size(value: Any) -> float:
    return float(np.max(np.abs(np.atleast_1d(value)))) if np.size(value) else 0.0


def _rejected(entries: Sequence[dict[str, Any]], diagnosis: PoseDiagnosis) -> Table:
    rows = [
        [e["cause"], e["where"], e["why"], *(f"{g:.0f} ({s:.1f})" for g, s in zip(
            e["gain_by_series"], e["standard_errors_by_series"], strict=True))]
        for e in entries
    ]  # fmt: skip
    head = (
        "Cause",
        "Where",
        "Why not",
        *(f"Gain in {data.name} (standard errors)" for data in diagnosis.sets),
    )
    return Table(head, rows)


def _gauge(document: dict[str, Any]) -> Table:
    rows = [
        [e["cause"], e["where"], ", ".join(e["parameters"]), e["imitated_by"]]
        for e in document["not_distinguishable_from_placement"]
    ]
    return Table(("Cause", "Where", "Parameters", "Imitated by"), rows)


def _coverage(document: dict[str, Any]) -> Table:
    rows = [
        [
            f"joint {e['joint']}",
            f"{100 * e['share_of_turn']:.0f} %",
            ", ".join(f"{rad_to_deg(a):.0f} to {rad_to_deg(b):.0f}" for a, b in e["ranges"]),
        ]
        for e in document["coverage"]
    ]
    return Table(("Joint", "Share of a turn", "Ranges [deg]"), rows)


def _next(document: dict[str, Any]) -> list[Table]:
    rows = [
        [
            str(i + 1),
            ", ".join(f"{a:.1f}" for a in rad_to_deg(np.array(one["q"]))),
            f"{one['information']:.1f}",
        ]
        for i, one in enumerate(document["next_poses"])
    ]
    head = ("", "Joint angles [deg]", "What it adds to the ones above [nat]")
    return [Table(head, rows)] if rows else []


def _checks(document: dict[str, Any]) -> Table:
    rows = [
        [
            c["set"],
            str(c["rows"]),
            _um(c["baseline"], "rmse"),
            _um(c["extended"], "rmse"),
            f"{_um(c['baseline'], 'rotation_rmse')} / {_um(c['extended'], 'rotation_rmse')}",
            ", ".join(map(str, c["gross_errors"][:20])) or "-",
            ", ".join(f"{k} {100 * v:.0f} %" for k, v in c["outside_coverage"].items() if v > 0.005)
            or "none",
        ]
        for c in document["checks"]
    ]
    head = (
        "Set", "Rows", "Nominal [um]", "Extended [um]", "Rotation before / after [urad]", "Gross errors",
        "Rows at angles never visited",
    )  # fmt: skip
    return Table(head, rows)


_CURVES = """Residual joint angle over the recorded angle, by series. Left with the nominal model and the causes other
than the joint's own periodic error, right on rows that the fit has not seen."""

_METHOD = """Every series has a placement of its own: base in tracker and target on flange. Each cause displaces
the robot's frames a little, in proportion to its numbers; all are fitted together by weighted least squares that
gross errors cannot steer. How large the numbers of a kind usually are is learnt from the data, so that what the data
do not call for vanishes. Each series is cut into ten contiguous blocks, every fifth block is predicted by a fit that
has not seen it; whole series are predicted with only the placement fitted, on rows marked for that. A cause is named
if taking it away makes the blocks left out worse by more than their scatter allows, in more than one series where
there are several."""
