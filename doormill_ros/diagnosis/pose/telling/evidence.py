"""What the page of a diagnosis of poses shows as evidence: series, joint curves, spectra, visited angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.telling import pictures
from doormill_ros.pages.page import Block, Charts, PageSection, Paragraphs, Table
from doormill_ros.units import m_to_um, rad_to_deg

_ROTATION = "Rotation before / after [urad]"
_CURVES = """Residual joint angle over the recorded angle, by series. Left with the nominal model and the causes other
than the joint's own periodic error, right on rows that the fit has not seen."""


def evidence(diagnosis: PoseDiagnosis, series: Sequence[Mapping[str, Any]]) -> list[PageSection]:
    """Sections between the causes and the candidates; `series` as under `sets` of diagnosis.json."""
    sections = [
        PageSection("Every series", [_series(series)]),
        PageSection("Position error before and after", [Charts(pictures.before_and_after(diagnosis))]),
    ]
    curves = pictures.joint_curves(diagnosis)
    if curves:
        title = "The pattern that gave it away: each joint against its own angle"
        sections.append(PageSection(title, [Paragraphs([_CURVES]), Charts(curves, "halves")]))
    return [
        *sections,
        PageSection("Amplitudes by order", [Charts(pictures.spectra(diagnosis))]),
        PageSection("Course of the recording", [Charts(pictures.over_rows(diagnosis))]),
    ]


def candidates_blocks(diagnosis: PoseDiagnosis, document: Mapping[str, Any]) -> list[Block]:
    """What each cause is worth on rows left out, and what is not named; `document` is that of the kind's own keys."""
    return [
        Charts([pictures.candidates_chart(diagnosis)], "wide"),
        Paragraphs(["What only helps within one series:"]),
        _rejected(document["only_within_one_series"], diagnosis),
        Paragraphs(["What does not help:"]),
        _rejected(document["rejected"], diagnosis),
    ]


def closing(
    diagnosis: PoseDiagnosis, document: Mapping[str, Any], checks: Sequence[Mapping[str, Any]]
) -> list[PageSection]:
    """Sections at the end of the page."""
    sections = [
        PageSection("What no pose can tell from the placement", [_gauge(document)]),
        PageSection("Joint angles that were visited", [_coverage(document)]),
        PageSection(
            "How sure: what was expected of rows that no fit had seen",
            [
                Charts(pictures.calibration(document["certainty"]), "halves"),
                _certainty(document["certainty"]),
            ],
        ),
    ]
    if checks:
        sections.append(PageSection("Checked series in detail", [_checks(checks)]))
    sources = dict.fromkeys(data.source for data in diagnosis.sets if data.source)
    if sources:
        sections.append(PageSection("Data", [Paragraphs(list(sources))]))
    return sections


def _um(entry: Mapping[str, Any], key: str) -> str:
    return f"{m_to_um(entry[key]):.0f}" if key in entry else "-"


def _series(series: Sequence[Mapping[str, Any]]) -> Table:
    rows = []
    for one in series:
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
        "Series left out", _ROTATION,
    )  # fmt: skip
    return _table(head, rows, any("rotation_rmse" in one["baseline"] for one in series))


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], oriented: bool) -> Table:
    """A table, without its column of rotations where none was measured."""
    shown = [i for i, name in enumerate(head) if oriented or name != _ROTATION]
    return Table(tuple(head[i] for i in shown), [[row[i] for i in shown] for row in rows])


def _rejected(entries: Sequence[Mapping[str, Any]], diagnosis: PoseDiagnosis) -> Table:
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


def _gauge(document: Mapping[str, Any]) -> Table:
    rows = [
        [e["cause"], e["where"], ", ".join(e["parameters"]), e["imitated_by"]]
        for e in document["not_distinguishable_from_placement"]
    ]
    rows += [[e["what"], e["where"], "-", e["why"]] for e in document["not_determined"]]
    return Table(("Cause", "Where", "Parameters", "Imitated by"), rows)


def _certainty(parts: Mapping[str, Sequence[Mapping[str, Any]]]) -> Table:
    rows = [
        [
            part.replace("_", " "),
            one["set"],
            _um(one, "expected_rmse"),
            _um(one, "rmse"),
            f"{100 * one['within_95']:.0f} %",
        ]
        for part, entries in parts.items()
        for one in entries
    ]
    return Table(("Left out", "Series", "Expected [um]", "Came [um]", "Inside intervals of 95 %"), rows)


def _coverage(document: Mapping[str, Any]) -> Table:
    rows = [
        [
            f"joint {e['joint']}",
            f"{100 * e['share_of_turn']:.0f} %",
            ", ".join(f"{rad_to_deg(a):.0f} to {rad_to_deg(b):.0f}" for a, b in e["ranges"]),
        ]
        for e in document["coverage"]
    ]
    return Table(("Joint", "Share of a turn", "Ranges [deg]"), rows)


def next_poses_table(poses: Sequence[Mapping[str, Any]]) -> list[Block]:
    """The poses to measure next, as under `next_poses` of diagnosis.json."""
    rows = [
        [
            str(i + 1),
            ", ".join(f"{a:.1f}" for a in rad_to_deg(np.array(one["q"]))),
            f"{one['information']:.1f}",
        ]
        for i, one in enumerate(poses)
    ]
    head = ("", "Joint angles [deg]", "What it adds to the ones above [nat]")
    return [Table(head, rows)] if rows else []


def _checks(checks: Sequence[Mapping[str, Any]]) -> Table:
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
        for c in checks
    ]
    head = (
        "Set", "Rows", "Nominal [um]", "Extended [um]", _ROTATION, "Gross errors",
        "Rows at angles never visited",
    )  # fmt: skip
    return _table(head, rows, any("rotation_rmse" in c["baseline"] for c in checks))
