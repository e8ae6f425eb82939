"""The charts of a diagnosis."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.words.verdict import rmse
from doormill_ros.diagnosis.core.words.wording import MICRO, spoken
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis, LoadingProblem
from doormill_ros.pages.charts import BLUE, DARK, GREY, HALF, RED, WIDE, BarRow, Curve, bars, scatter
from doormill_ros.robot_model.elastic.causes.cause import DIRECTION, OWN_TORQUE, TIME, ElasticCause
from doormill_ros.units import m_to_um

MOST = 16  #: rows of a chart by group


def stages(diagnosis: LoadingDiagnosis) -> list[tuple[str, str, Fit[ElasticCause]]]:
    """Name, colour and model of what is shown side by side: before, and after where something was found."""
    if not diagnosis.findings:
        return [("", RED, diagnosis.baseline)]
    return [("before", RED, diagnosis.baseline), ("after", BLUE, diagnosis.extended)]


def before_and_after(diagnosis: LoadingDiagnosis) -> list[str]:
    """Measured against simulated displacement, and what is left over on one scale, before and after."""
    kept, noise = diagnosis.kept, m_to_um(diagnosis.problem.noise_floor)
    measured = diagnosis.problem.data.displacement[kept]
    ends = m_to_um(np.array([measured.min(), measured.max()]))
    largest = m_to_um(max(float(np.abs(found.held_out[kept]).max()) for _, _, found in stages(diagnosis)))
    titles = ("simulation now", "extended model, configurations left out")
    rows: list[list[str]] = [[], []]
    for title, (_, colour, found) in zip(titles, stages(diagnosis), strict=False):
        x, left = m_to_um(measured.ravel()), m_to_um(found.held_out[kept].ravel())
        rows[0].append(
            scatter(
                title,
                f"measured [{MICRO}m]",
                f"simulated [{MICRO}m]",
                dots=[Curve("", colour, x, x - left)],
                lines=[Curve("", DARK, ends, ends)],
                square=True,
                width=HALF,
            )
        )
        rows[1].append(
            scatter(
                f"{title}: what is left",
                f"measured [{MICRO}m]",
                f"measured - simulated [{MICRO}m]",
                dots=[Curve("", colour, x, left)],
                band=2.0 * noise,
                limits=(-largest, largest),
                width=HALF,
            )
        )
    return [*rows[0], *rows[1]]


def residual_by_joint(diagnosis: LoadingDiagnosis) -> list[str]:
    """Residual along the motion of every joint over its torque, before and after, all on one scale."""
    problem, kept = diagnosis.problem, diagnosis.kept
    drawn = []
    for k in range(6):
        lever = problem.case.joint_twist(k)[:, :3]
        arm = np.linalg.norm(lever, axis=1)
        rows = kept & (arm > 0.01)
        if rows.sum() < 3 or problem.case.largest_torque[k] < 1e-3:
            continue
        along = lever[rows] / arm[rows, None]
        series = [
            Curve(
                name,
                colour,
                problem.case.torque[rows, k],
                m_to_um(np.sum(found.held_out[rows] * along, axis=1)),
            )
            for name, colour, found in stages(diagnosis)
        ]
        drawn.append((f"joint {k + 1}", series))
    largest = max((float(np.abs(y).max()) for _, series in drawn for *_, y in series), default=1.0)
    return [
        scatter(
            title,
            "torque [N m]",
            f"residual along its motion [{MICRO}m]",
            dots=series,
            band=2.0 * m_to_um(problem.noise_floor),
            limits=(-largest, largest),
        )
        for title, series in drawn
    ]


def angle(residual: FloatArray, lever: FloatArray, size: FloatArray) -> FloatArray:
    """Joint angle that would leave this residual, shape (n,) [rad]."""
    turn: FloatArray = np.sum(residual * lever, axis=1) / np.maximum(size, 1e-12)
    return turn


def residual_by_circumstance(diagnosis: LoadingDiagnosis) -> list[str]:
    """Residual over load, time between measurements and time of day, before and after."""
    problem, kept = diagnosis.problem, diagnosis.kept
    data = problem.data
    usual = m_to_um(problem.noise_floor) * np.sqrt(problem.components)
    charts = []
    for title, label, values in (
        ("by load", "force [N]", np.linalg.norm(problem.case.force, axis=1)),
        ("by time under load", "time between the two measurements [s]", data.dt),
        ("by time of the test", "time since the start [s]", data.time),
    ):
        series = [
            Curve(name, colour, values[kept], m_to_um(np.linalg.norm(found.held_out[kept], axis=1)))
            for name, colour, found in stages(diagnosis)
        ]
        ends = np.array([values[kept].min(), values[kept].max()])
        line = Curve("noise", DARK, ends, np.full(2, usual))
        charts.append(scatter(title, label, f"length of the residual [{MICRO}m]", series, [line]))
    return charts


def residual_by_group(diagnosis: LoadingDiagnosis) -> list[str]:
    """Root mean square residual by direction of the load, reflector and posture, before and after."""
    problem, data = diagnosis.problem, diagnosis.problem.data
    force = problem.case.force
    main = np.abs(force).argmax(axis=1)
    sign = np.where(force[np.arange(len(force)), main] > 0.0, "+", "-")
    direction = np.array([f"{s}{'xyz'[m]}" for s, m in zip(sign, main, strict=True)])
    posture = np.array([f"posture {c + 1}" for c in problem.configuration])
    charts = []
    for title, groups in (
        ("by direction of the load, base frame", direction),
        ("by reflector", data.reflector),
        ("by posture", posture),
    ):
        names = list(dict.fromkeys(groups[diagnosis.kept].tolist()))
        ordered = names if groups is posture else sorted(names)
        masks = {name: diagnosis.kept & (groups == name) for name in ordered}
        rows = [
            BarRow(
                name,
                [m_to_um(rmse(f.held_out, mask, problem.components)) for _, _, f in stages(diagnosis)],
                [colour for _, colour, _ in stages(diagnosis)],
            )
            for name, mask in masks.items()
        ]
        if len(rows) > MOST:
            title = f"{title} (the worst {MOST} of {len(rows)})"
            rows = sorted(rows, key=lambda row: -row.values[0])[:MOST]
        charts.append(bars(title, f"{MICRO}m", rows, ("noise", m_to_um(problem.noise_floor))))
    return charts


def pattern_of(diagnosis: LoadingDiagnosis, finding: Finding[ElasticCause]) -> str:
    """What gave a cause away: the residual without it, against what drives it."""
    problem, kept, cause = diagnosis.problem, diagnosis.kept, finding.cause
    effect = _effect(diagnosis.problem, diagnosis.extended, cause)
    residual = diagnosis.extended.prediction.residual + effect
    if cause.driver in (OWN_TORQUE, DIRECTION):
        return _over_torque(diagnosis, cause, residual, effect)
    if cause.driver == TIME:
        axis = finding.values / max(float(np.linalg.norm(finding.values)), 1e-30)
        dt = problem.data.dt[kept]
        line = np.array([dt.min(), dt.max()])
        return scatter(
            f"{spoken(cause)}: what the model without it leaves",
            "time between the two measurements [s]",
            f"residual along the drift [{MICRO}m]",
            [Curve("", RED, dt, m_to_um(residual[kept] @ axis))],
            [Curve("fit", BLUE, line, m_to_um(line) * float(np.linalg.norm(finding.values)))],
            width=WIDE,
        )
    return _against_prediction(f"{spoken(cause)}: ", residual[kept], effect[kept])


def patterns_without_a_name(diagnosis: LoadingDiagnosis) -> list[str]:
    """The same for the shapes in the best model that belong to no cause."""
    best, kept = diagnosis.best, diagnosis.kept
    charts = []
    for member in best.members:
        if not member.named:
            effect = _effect(diagnosis.problem, best, member)
            residual = best.prediction.residual + effect
            charts.append(
                _against_prediction(f"{spoken(member)} (no cause): ", residual[kept], effect[kept], GREY)
            )
    return charts


def _over_torque(
    diagnosis: LoadingDiagnosis, cause: ElasticCause, residual: FloatArray, effect: FloatArray
) -> str:
    """Joint angle over torque, one colour for each side from which the joint came."""
    problem = diagnosis.problem
    k = int(cause.where[-1]) - 1
    lever = problem.case.joint_twist(k)[:, :3]
    size = np.sum(lever**2, axis=1)
    rows = diagnosis.kept & (size > 0.01**2)
    torque = problem.case.torque[:, k]
    along = problem.data.direction[:, k] * torque
    series, fitted = [], []
    for name, colour, mask in (
        ("moved along the load", RED, along > 0),
        ("pre-loaded", BLUE, along < 0),
        ("unknown", GREY, along == 0),
    ):
        at = np.flatnonzero(rows & mask)
        at = at[np.argsort(torque[at])]
        if len(at):
            series.append(Curve(name, colour, torque[at], m_to_um(angle(residual, lever, size))[at]))
            fitted.append(Curve(name, colour, torque[at], m_to_um(angle(effect, lever, size))[at]))
    title = f"{spoken(cause)}: what the springs leave (dots) and what the cause says (lines)"
    return scatter(title, "torque [N m]", f"joint angle [{MICRO}rad]", series, fitted, width=WIDE)


def _against_prediction(title: str, residual: FloatArray, effect: FloatArray, colour: str = RED) -> str:
    x = m_to_um(effect.ravel())
    ends = np.array([x.min(), x.max()])
    return scatter(
        f"{title}what the model without it leaves, over what it predicts",
        f"predicted [{MICRO}m]",
        f"residual without it [{MICRO}m]",
        [Curve("", colour, x, m_to_um(residual.ravel()))],
        [Curve("", DARK, ends, ends)],
        width=WIDE,
    )


def _effect(problem: LoadingProblem, found: Fit[ElasticCause], cause: ElasticCause) -> FloatArray:
    """Displacement that a cause adds to a model, shape (n, 3) [m]."""
    theta = found.theta.copy()
    theta[found.part(cause)] = 0.0
    return problem.predict(found.members, theta).residual - found.prediction.residual
