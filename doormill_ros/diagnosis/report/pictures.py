"""The charts of a diagnosis."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.causes.cause import Cause
from doormill_ros.diagnosis.diagnosis import Diagnosis
from doormill_ros.diagnosis.finding import Finding
from doormill_ros.diagnosis.problem import split
from doormill_ros.diagnosis.report.svg import AFTER, BEFORE, GOOD, OTHER, Bars, Scatter

UM = 1e6  #: micrometres in a metre


def before_and_after(diagnosis: Diagnosis) -> list[str]:
    """Measured against simulated displacement, with the model in question and with the extended one."""
    kept = diagnosis.kept
    measured = diagnosis.problem.data.displacement[kept]
    charts = []
    for title, residual, colour in (
        ("as simulated now", diagnosis.baseline.held_out, BEFORE),
        ("with the extended model, on data it has not seen", diagnosis.extended.held_out, AFTER),
    ):
        simulated = measured - residual[kept]
        ends = UM * np.array([measured.min(), measured.max()])
        charts.append(
            Scatter(
                title,
                "measured [um]",
                "simulated [um]",
                series=[("", colour, UM * measured.ravel(), UM * simulated.ravel())],
                lines=[("", "#555", ends, ends)],
                square=True,
            ).svg()
        )
    return charts


def residual_by_joint(diagnosis: Diagnosis) -> list[str]:
    """Residual of every joint as an angle over its torque, before and after."""
    problem, kept = diagnosis.problem, diagnosis.kept
    charts = []
    for k in range(6):
        lever = problem.case.joint_twist(k)[:, :3]
        size = np.sum(lever**2, axis=1)
        rows = kept & (size > 0.01**2)
        if rows.sum() < 3 or problem.case.largest_torque[k] < 1e-3:
            continue
        series = [
            (name, colour, problem.case.torque[rows, k], UM * angle(residual, lever, size)[rows])
            for name, colour, residual in (
                ("before", BEFORE, diagnosis.baseline.held_out),
                ("after", AFTER, diagnosis.extended.held_out),
            )
        ]
        charts.append(
            Scatter(f"joint {k + 1}", "torque [N m]", "residual as joint angle [urad]", series=series).svg()
        )
    return charts


def angle(residual: np.ndarray, lever: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Joint angle that would leave this residual, shape (n,) [rad]."""
    return np.sum(residual * lever, axis=1) / np.maximum(size, 1e-12)


def residual_by_circumstance(diagnosis: Diagnosis) -> list[str]:
    """Residual over load, time between measurements and time of day, before and after."""
    problem, kept = diagnosis.problem, diagnosis.kept
    data = problem.data
    charts = []
    for title, label, values in (
        ("by load", "force [N]", np.linalg.norm(problem.case.force, axis=1)),
        ("by time between the two measurements", "dt [s]", data.dt),
        ("by time of the test", "t [s]", data.time),
    ):
        series = [
            (name, colour, values[kept], UM * np.linalg.norm(residual[kept], axis=1))
            for name, colour, residual in (
                ("before", BEFORE, diagnosis.baseline.held_out),
                ("after", AFTER, diagnosis.extended.held_out),
            )
        ]
        charts.append(Scatter(title, label, "length of the residual [um]", series=series).svg())
    return charts


def residual_by_group(diagnosis: Diagnosis) -> list[str]:
    """Root mean square residual by direction of the load, reflector and posture, before and after."""
    problem, data = diagnosis.problem, diagnosis.problem.data
    force = problem.case.force
    main = np.abs(force).argmax(axis=1)
    sign = np.where(force[np.arange(len(force)), main] > 0.0, "+", "-")
    direction = np.array([f"load along {s}{'xyz'[m]}" for s, m in zip(sign, main, strict=True)])
    posture = np.array([f"posture {c + 1}" for c in problem.configuration])
    charts = []
    for title, groups in (
        ("by direction of the load (base frame)", direction),
        ("by reflector", data.reflector),
        ("by posture", posture),
    ):
        rows = []
        names = list(dict.fromkeys(groups.tolist()))
        for name in sorted(names) if title != "by posture" else names:
            mask = diagnosis.kept & (groups == name)
            if not mask.any():
                continue
            for when, residual, colour in (
                ("before", diagnosis.baseline.held_out, BEFORE),
                ("after", diagnosis.extended.held_out, AFTER),
            ):
                rows.append((f"{name}, {when}", UM * float(np.sqrt(np.mean(residual[mask] ** 2))), colour))
        charts.append(Bars(title, "um", rows, ("noise", UM * problem.noise_floor)).svg())
    return charts


def pattern_of(diagnosis: Diagnosis, finding: Finding) -> str:
    """What gave a cause away: the residual without it, against what drives it."""
    problem, kept, cause = diagnosis.problem, diagnosis.kept, finding.cause
    without = diagnosis.search.without(diagnosis.extended, cause)
    effect = _effect(diagnosis, cause)
    residual = diagnosis.extended.prediction.residual + effect
    if cause.name in ("joint_stiffness", "joint_hardening", "joint_backlash", "joint_friction"):
        k = int(cause.where[-1]) - 1
        lever = problem.case.joint_twist(k)[:, :3]
        size = np.sum(lever**2, axis=1)
        rows = kept & (size > 0.01**2)
        torque = problem.case.torque[:, k]
        along = problem.data.direction[:, k] * torque
        known = [
            ("moved along the load", BEFORE, along > 0),
            ("pre-loaded", AFTER, along < 0),
            ("unknown", OTHER, along == 0),
        ]
        series = [
            (name, colour, torque[rows & mask], UM * angle(residual, lever, size)[rows & mask])
            for name, colour, mask in known
            if np.any(rows & mask)
        ]
        fitted = [
            (
                name,
                colour,
                torque[rows & mask][np.argsort(torque[rows & mask])],
                UM * angle(effect, lever, size)[rows & mask][np.argsort(torque[rows & mask])],
            )
            for name, colour, mask in known
            if np.any(rows & mask)
        ]
        return Scatter(
            f"{cause!r}: what the springs leave",
            "torque [N m]",
            "joint angle [urad]",
            series,
            fitted,
            width=760,
        ).svg()
    if cause.name == "thermal_drift":
        axis = finding.values / max(float(np.linalg.norm(finding.values)), 1e-30)
        dt = problem.data.dt[kept]
        line = np.array([dt.min(), dt.max()])
        return Scatter(
            f"{cause!r}: what the springs leave",
            "dt [s]",
            "residual along the drift [um]",
            [("", BEFORE, dt, UM * residual[kept] @ axis)],
            [("fit", AFTER, line, UM * line * float(np.linalg.norm(finding.values)))],
            width=760,
        ).svg()
    del without
    x = UM * effect[kept].ravel()
    ends = np.array([x.min(), x.max()])
    return Scatter(
        f"{cause!r}: what the model without it leaves, against what the cause predicts",
        "predicted by the cause [um]",
        "residual without the cause [um]",
        [("", BEFORE, x, UM * residual[kept].ravel())],
        [("", "#555", ends, ends)],
        width=760,
    ).svg()


def _effect(diagnosis: Diagnosis, cause: Cause) -> np.ndarray:
    """Displacement that a cause adds to the extended model, shape (n, 3) [m]."""
    extended = diagnosis.extended
    theta = extended.theta.copy()
    at = 0
    for member, _ in split(extended.members, theta):
        if member is cause:
            theta[at : at + member.size] = 0.0
        at += member.size
    return diagnosis.problem.predict(extended.members, theta).residual - extended.prediction.residual


def candidates_chart(diagnosis: Diagnosis) -> str:
    """Held-out residual of every single candidate that was fitted, the best first."""
    named = {finding.cause.key for finding in diagnosis.findings}
    kept = diagnosis.kept
    rows: list[tuple[str, float, str]] = []
    for found in sorted(diagnosis.search.fits.values(), key=diagnosis.search.total):
        label = " + ".join(f"{c.name} {c.where}" for c in found.members) or "no cause (simulation as it is)"
        value = UM * float(np.sqrt(np.mean(found.held_out[kept] ** 2)))
        own = {c.key for c in found.members} == named and bool(found.members or not named)
        known = all(c.named for c in found.members)
        rows.append((label[:44], value, GOOD if own else AFTER if known else OTHER))
        if len(rows) == 14:
            break
    return Bars(
        "Candidates by held-out residual (green: chosen, grey: patterns without a name)",
        "um",
        rows,
        ("noise", UM * diagnosis.problem.noise_floor),
    ).svg()
