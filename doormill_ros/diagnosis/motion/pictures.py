"""The charts of a diagnosis of moving joints."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.motion.diagnosis import MotionDiagnosis
from doormill_ros.diagnosis.motion.examination import JointFinding
from doormill_ros.diagnosis.motion.orders import spectrum
from doormill_ros.pages.charts import BLUE, GREY, HALF, RED, BarRow, Curve, bars, scatter
from doormill_ros.units import UM

_POINTS = 1200  #: of a curve in one chart
_ORDERS = 1500.0  #: waves a turn that a spectrum shows


def course(diagnosis: MotionDiagnosis) -> list[str]:
    """Difference of the encoders over the time, before and after, of every joint and recording."""
    charts = []
    for finding in diagnosis.joints:
        problem = finding.problem
        for i, motion in enumerate(problem.motions):
            rows = np.flatnonzero(problem.recording == i)
            rows = rows[np.unique(np.linspace(0, len(rows) - 1, _POINTS).astype(int))]
            time = motion.time[rows - rows[0]]
            lines = [
                Curve("springs as published", RED, time, finding.baseline.held_out[rows] / UM),
                Curve("extended, blocks left out", BLUE, time, finding.extended.held_out[rows] / UM),
            ]
            title = f"{problem.where}, {diagnosis.sets[i].name}"
            charts.append(scatter(title, "time [s]", "residual [urad]", lines=lines, width=HALF))
    return charts


def against_speed(finding: JointFinding) -> str:
    """What the published springs leave over the joint's speed: a late encoder shows as a line."""
    problem = finding.problem
    speed = np.concatenate([motion.seen().speed for motion in problem.motions])
    rows = np.unique(np.linspace(0, len(speed) - 1, _POINTS).astype(int))
    clouds = [
        Curve("springs as published", RED, speed[rows], finding.baseline.residual[rows] / UM),
        Curve("extended", BLUE, speed[rows], finding.extended.residual[rows] / UM),
    ]
    return scatter(problem.where, "speed [rad/s]", "residual [urad]", clouds)


def against_torque(finding: JointFinding) -> str:
    """What is left over the joint's torque."""
    problem = finding.problem
    torque = np.concatenate([motion.torque for motion in problem.motions])
    rows = np.unique(np.linspace(0, len(torque) - 1, _POINTS).astype(int))
    clouds = [Curve("extended", BLUE, torque[rows], finding.extended.residual[rows] / UM)]
    return scatter(problem.where, "torque [N m]", "residual [urad]", clouds)


def orders(finding: JointFinding) -> str:
    """Waves over the angle in what is left, before and after."""
    problem = finding.problem
    lines = []
    for name, colour, fit in (("published", RED, finding.baseline), ("extended", BLUE, finding.extended)):
        power = np.sqrt(spectrum(problem, fit.residual, quick=True)) * 2.0 / len(problem) / UM
        order = np.arange(len(power)) / 4.0
        shown = (order > 10.0) & (order < _ORDERS)
        lines.append(Curve(name, colour, order[shown][::4], power[shown][::4]))
    return scatter(problem.where, "waves a turn of the joint", "amplitude, about [urad]", lines=lines)


def by_joint(diagnosis: MotionDiagnosis) -> str:
    """Held-out residual of every joint, before and after."""
    rows = [
        BarRow(
            one.problem.where,
            [
                one.problem.rmse(one.baseline.held_out) / UM,
                one.problem.rmse(one.extended.held_out) / UM,
                one.problem.rmse(one.best.held_out) / UM,
            ],
            [RED, BLUE, GREY],
        )
        for one in diagnosis.joints
    ]
    return bars(
        "held-out residual: springs as published, extended, with shapes that have no name",
        "urad",
        rows,
        width=HALF * 2,
    )
