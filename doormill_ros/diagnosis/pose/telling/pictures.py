"""The charts of a pose diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.laws import numbers_told
from doormill_ros.pages.charts import BLUE, GREEN, GREY, HALF, RED, WIDE, BarRow, Curve, bars, scatter
from doormill_ros.robot_model.pose.chain import derivatives, joint_turn
from doormill_ros.units import m_to_mm, m_to_um, rad_to_deg

_COLOURS = (RED, BLUE, GREEN, GREY, "#7a4fa3", "#b08a00")
#: Points of a series in one chart.
_POINTS = 700


def before_and_after(diagnosis: PoseDiagnosis) -> list[str]:
    """Share of poses below an error, before and after, for every series."""
    charts = []
    share = np.linspace(0.0, 1.0, 200)
    for index, data in enumerate(diagnosis.sets):
        good = ~diagnosis.gross[index]
        lines = []
        for name, colour, errors in (
            ("nominal", RED, diagnosis.before.blocks),
            ("blocks left out", BLUE, diagnosis.after.blocks),
            ("series left out", GREY, diagnosis.after.series),
        ):
            if errors:
                size = m_to_um(np.linalg.norm(errors[index][good, :3], axis=1))
                lines.append(Curve(name, colour, np.quantile(size, share), 100.0 * share))
        charts.append(scatter(data.name, "position error [um]", "poses below [%]", lines=lines))
    return charts


def joint_angle(diagnosis: PoseDiagnosis, series: int, errors: FloatArray) -> FloatArray:
    """Residual turn of every joint that explains a pose error best, shape (n, J) [rad]."""
    problem = diagnosis.extended.problem
    scale = problem.scale(series)
    turns = [joint_turn(k) for k in range(1, problem.joints + 1)]
    D = derivatives(problem.frames(series), problem.placements[series])[:, turns] * scale
    H = np.einsum("nac,nbc->nab", D, D)
    # A target on the axis of a joint does not show its turn.
    size: FloatArray = np.maximum(np.sqrt(np.einsum("naa->na", H)), 1e-12)
    H = H / (size[:, :, None] * size[:, None, :]) + 1e-2 * np.eye(problem.joints)
    g = np.einsum("nac,nc->na", D, errors * scale) / size
    return np.linalg.solve(H, g[:, :, None])[:, :, 0] / size


def joint_curves(diagnosis: PoseDiagnosis) -> list[str]:
    """Residual joint angle over the joint's own angle, without its periodic error and on unseen rows."""
    problem = diagnosis.extended.problem
    own = {
        cause.where: (cause, part)
        for cause, part in diagnosis.extended.parts
        if cause.spectrum(problem.x[part]) is not None
    }
    if not own:
        return []
    residual = [joint_angle(diagnosis, i, errors) for i, errors in enumerate(diagnosis.after.blocks)]
    charts = []
    for k in range(1, problem.joints + 1):
        if f"joint {k}" not in own:
            continue
        cause, part = own[f"joint {k}"]
        clouds: list[list[Curve]] = [[], []]
        curve = []
        for index, data in enumerate(diagnosis.sets):
            pick = np.unique(np.linspace(0, len(data) - 1, _POINTS).astype(int))
            pick = pick[~diagnosis.gross[index][pick]]
            angle = rad_to_deg(data.q[pick, k - 1])
            left = m_to_mm(residual[index][pick, k - 1])
            error = m_to_mm(cause.columns(problem.views[index])[0].basis[pick] @ problem.x[part])
            colour = _COLOURS[index % len(_COLOURS)]
            clouds[0].append(Curve(data.name, colour, angle, left + error))
            clouds[1].append(Curve(data.name, colour, angle, left))
            curve.append(left + error)
        span = 1.2 * float(np.quantile(np.abs(np.concatenate(curve)), 0.99))
        for title, series in (("without its own error", clouds[0]), ("after", clouds[1])):
            inside = [Curve(n, c, x[abs(y) < span], y[abs(y) < span]) for n, c, x, y in series]
            charts.append(
                scatter(
                    f"joint {k}, {title}",
                    "recorded angle [deg]",
                    "residual angle [mrad]",
                    inside,
                    width=HALF,
                    limits=(-span, span),
                )
            )
    return charts


def spectra(diagnosis: PoseDiagnosis) -> list[str]:
    """Amplitude of every order of the periodic errors."""
    charts = []
    told, _ = numbers_told(diagnosis)
    for cause, part in diagnosis.extended.parts:
        if (found := cause.spectrum(told.x[part])) is not None:
            line = Curve("", BLUE, found[0], m_to_um(found[1]))
            charts.append(scatter(cause.where, "order", "amplitude [urad]", [line]))
    return charts


def calibration(parts: Mapping[str, Sequence[Mapping[str, Any]]]) -> list[str]:
    """Position error that was expected of rows no fit had seen against what came, as under `certainty`."""
    charts = []
    for part, entries in parts.items():
        clouds, most = [], 0.0
        for index, one in enumerate(entries):
            x = m_to_um(np.array([group["expected_rmse"] for group in one["groups"]]))
            y = m_to_um(np.array([group["rmse"] for group in one["groups"]]))
            clouds.append(Curve(one["set"], _COLOURS[index % len(_COLOURS)], x, y))
            most = max(most, float(x.max()), float(y.max()))
        line = Curve("as expected", GREY, np.array([0.0, most]), np.array([0.0, most]))
        title = part.replace("_", " ")
        charts.append(scatter(title, "expected [um]", "came [um]", clouds, lines=[line], width=HALF))
    return charts


def over_rows(diagnosis: PoseDiagnosis) -> list[str]:
    """Length of the position error over the recording."""
    charts = []
    for index, data in enumerate(diagnosis.sets):
        good = np.flatnonzero(~diagnosis.gross[index])
        pick = good[np.unique(np.linspace(0, len(good) - 1, _POINTS).astype(int))]
        series = [
            Curve(
                name,
                colour,
                data.row[pick].astype(float),
                m_to_um(np.linalg.norm(errors[index][pick, :3], axis=1)),
            )
            for name, colour, errors in (
                ("nominal", RED, diagnosis.before.blocks),
                ("blocks left out", BLUE, diagnosis.after.blocks),
            )
        ]
        charts.append(scatter(data.name, "row", "position error [um]", series))
    return charts


def candidates_chart(diagnosis: PoseDiagnosis) -> str:
    """Held-out position error when a cause is taken away."""
    kept = [~bad for bad in diagnosis.gross]
    squares = [np.sum(e[good, :3] ** 2, axis=1) for e, good in zip(diagnosis.after.blocks, kept, strict=True)]
    now = m_to_um(float(np.sqrt(np.mean(np.concatenate(squares)))))
    rows = [
        BarRow(f"without {score.cause!r}".replace("_", " "), [m_to_um(score.rmse_without)], [BLUE])
        for score in sorted(diagnosis.established, key=lambda s: -s.rmse_without)
    ]
    return bars("held-out error when one cause is taken away", "um", rows, ("with all", now), WIDE)
