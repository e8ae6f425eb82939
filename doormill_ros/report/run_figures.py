"""Pictures of how a run went: pose with uncertainty, handshake over time, deflection along the path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle

from doormill_ros.messages.from_message import transform_of
from doormill_ros.report.figures import svg
from doormill_ros.report.run_record import HandshakeStep
from doormill_ros.units import m_to_mm, rad_to_deg

BLUE, RED, GREEN, GREY = "#1a73c8", "#d04a1a", "#3a9a3a", "#999999"
SMALL = 8
SIGMAS = 3.0
GOOD, BAD = ("ready", "done"), ("failed",)


def pose_figure(found: Any, true: Any, limits: Any) -> str:
    """Offset of the door within its limits, and the uncertainty much enlarged.

    Args:
        found: Accepted doormill_interfaces/DoorLocalization.
        true: doormill_interfaces/DoorPlacement of the simulation, or None.
        limits: `PlacementLimits` of the cell.
    """
    covariance = np.array(found.pose.covariance, dtype=float).reshape(6, 6)[1:3, 1:3] * 1e12  # um^2
    values, vectors = np.linalg.eigh(covariance)
    angle = rad_to_deg(float(np.arctan2(vectors[1, 1], vectors[0, 1])))
    figure = Figure(figsize=(8.0, 3.2))
    wide, near = figure.subplots(1, 2)
    y, z = m_to_mm(limits.y), m_to_mm(limits.z)
    wide.add_patch(Rectangle((-y, -z), 2 * y, 2 * z, fill=False, color=RED, linestyle="--"))
    wide.plot(m_to_mm(found.offset_y), m_to_mm(found.offset_z), "+", color=BLUE, markersize=14)
    wide.set(xlim=(-1.2 * y, 1.2 * y), ylim=(-1.2 * z, 1.2 * z), aspect="equal")
    _label(wide, "place of the corner; dashed: limits", "y [mm]", "z [mm]")
    width, height = 2.0 * SIGMAS * np.sqrt(np.maximum(values[::-1], 0.0))
    near.add_patch(Ellipse((0.0, 0.0), width, height, angle=angle, fill=False, color=BLUE))
    near.plot(0.0, 0.0, "+", color=BLUE, label="found")
    reach = 0.7 * max(width, height)
    if true is not None:
        off = 1e6 * (true.offset_y - found.offset_y), 1e6 * (true.offset_z - found.offset_z)
        near.plot(*off, "x", color=GREEN, label="true (simulation)")
        reach = max(reach, 1.2 * max(abs(v) for v in off))
    near.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    near.legend(fontsize=SMALL)
    _label(near, f"{SIGMAS:g} standard deviations about it", "y [um]", "z [um]")
    figure.tight_layout()
    return svg(figure)


def handshake_figure(steps: Sequence[HandshakeStep]) -> str:
    """States of the handshake over time; the time before the first change of state is left out."""
    figure = Figure(figsize=(8.0, 0.5 + 0.24 * len({s.state for s in steps})))
    axes = figure.add_subplot()
    names = list(dict.fromkeys(s.state for s in steps))
    end = steps[-1].begun + 0.02 * max(steps[-1].begun - steps[0].begun, 0.1)
    for index, step in enumerate(steps):
        until = steps[index + 1].begun if index + 1 < len(steps) else end
        colour = GREEN if step.state in GOOD else RED if step.state in BAD else BLUE
        axes.barh(
            names.index(step.state), max(until - step.begun, 0.0), left=step.begun, color=colour, height=0.6
        )
        axes.plot(step.begun, names.index(step.state), "|", color=colour, markersize=9)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.grid(axis="x", linewidth=0.3)
    _label(axes, "", "since the first state [s]", "")
    return svg(figure)


def deflection_figure(targets: Any, executed: Any) -> str:
    """Deflection along the path: predicted at the targets, and as the simulated robot bent while it cut.

    Args:
        targets: Accepted doormill_interfaces/TargetArray.
        executed: doormill_interfaces/ExecutedPath.
    """
    actual = np.array([transform_of(p)[:3, 3] for p in executed.actual])
    commanded = np.array([transform_of(p)[:3, 3] for p in executed.commanded])
    cutting = np.asarray(executed.cutting, dtype=bool)
    motion = np.asarray(executed.motion)
    size = np.linalg.norm(actual - commanded, axis=1)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(commanded, axis=0), axis=1) * cutting[1:])])
    figure = Figure(figsize=(8.0, 2.6))
    axes = figure.add_subplot()
    axes.plot(way[cutting], m_to_mm(size[cutting]), color=GREY, linewidth=1.0, label="executed")
    ends = np.flatnonzero(np.diff(motion, append=motion[-1] + 1) != 0)
    ends = [i for i in ends if cutting[i] and 0 <= motion[i] < len(targets.motions)]
    reached = [targets.targets[targets.motions[motion[i]].target].deflection.linear for i in ends]
    predicted = [np.linalg.norm([v.x, v.y, v.z]) for v in reached]
    if ends:
        axes.plot(
            way[ends],
            m_to_mm(np.array(predicted)),
            ".",
            color=BLUE,
            markersize=4,
            label="predicted at targets",
        )
    axes.legend(fontsize=SMALL)
    _label(axes, "", "way in the wood [m]", "deflection [mm]")
    return svg(figure)


def _label(axes: Any, title: str, x: str, y: str) -> None:
    axes.set_title(title, loc="left", fontsize=SMALL + 1)
    axes.set_xlabel(x, fontsize=SMALL)
    axes.set_ylabel(y, fontsize=SMALL)
    axes.tick_params(labelsize=SMALL)
