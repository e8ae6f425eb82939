"""Pictures of how a run went: pose, contour, deflection and correction as SVG, the camera's picture in a URL."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.messages.from_message import transform_of
from doormill_ros.messages.picture import picture_of
from doormill_ros.pages.charts import BLUE, GREEN, GREY, RED, sheet, styled, svg
from doormill_ros.pages.picture import MEDIA_TYPE, encode_picture
from doormill_ros.report.run_record import HandshakeStep
from doormill_ros.units import m_to_mm, m_to_um, rad_to_deg

SIGMAS = 3.0
GOOD, BAD = ("ready", "done"), ("failed",)


def picture_url(message: Any) -> str:
    """A sensor_msgs/Image as a JPEG data URL; overlays (rgb8) in colour, camera pictures in grey.

    Raises:
        BadPicture: Of an encoding that nobody here reads.
    """
    data = np.asarray(message.data, dtype=np.uint8)
    height, width = message.height, message.width
    coloured = message.encoding == "rgb8" and data.size == 3 * height * width
    picture = data.reshape(height, width, 3) if coloured else picture_of(message)
    return f"data:{MEDIA_TYPE};base64," + base64.b64encode(encode_picture(picture)).decode("ascii")


@styled
def deviation_figure(milled: Any) -> str:
    """Deviation along the contour of every feature, with and without correction."""
    features = [f for f in milled.features if len(f.arc_length)]
    figure = sheet(190 * max(1, len(features)))
    for index, feature in enumerate(features):
        axes = figure.add_subplot(len(features), 1, index + 1)
        along = m_to_mm(np.asarray(feature.arc_length))
        axes.plot(along, m_to_mm(np.asarray(feature.uncorrected)), color=GREY, label="uncorrected")
        axes.plot(along, m_to_mm(np.asarray(feature.corrected)), color=BLUE, label="corrected")
        axes.axhline(m_to_mm(milled.tolerance), color=RED, linewidth=0.8, linestyle="--")
        axes.axhline(-m_to_mm(milled.tolerance), color=RED, linewidth=0.8, linestyle="--")
        axes.set_title(f"{feature.feature} ({feature.kind})")
        axes.set_ylabel("deviation [mm]")
        if index == 0:
            axes.legend(loc="upper right")
    figure.axes[-1].set_xlabel("along the contour [mm]; dashed: tolerance")
    return svg(figure)


@styled
def correction_figure(targets: Any) -> str:
    """Predicted deflection and applied correction at each target."""
    nominal = np.array([_position(t.nominal) for t in targets.targets])
    corrected = np.array([_position(t.corrected) for t in targets.targets])
    linear = [t.deflection.linear for t in targets.targets]
    predicted = np.array([[v.x, v.y, v.z] for v in linear])
    figure = sheet(270)
    axes = figure.add_subplot()
    for axis, (name, colour) in enumerate(zip("xyz", (RED, BLUE, GREEN), strict=True)):
        axes.plot(m_to_mm((corrected - nominal)[:, axis]), color=colour, label=f"correction {name}")
        axes.plot(m_to_mm(predicted[:, axis]), color=colour, linestyle=":", label=f"deflection {name}")
    axes.set_xlabel("target")
    axes.set_ylabel("[mm]")
    axes.legend(ncols=3)
    return svg(figure)


def _position(pose: Any) -> list[float]:
    return [pose.position.x, pose.position.y, pose.position.z]


@styled
def pose_figure(found: Any, true: Any, limits: Any) -> str:
    """Offset of the door within its limits, and the uncertainty much enlarged.

    Args:
        found: Accepted doormill_interfaces/DoorLocalization.
        true: doormill_interfaces/DoorPlacement of the simulation, or None.
        limits: `PlacementLimits` of the cell.
    """
    from matplotlib.patches import Ellipse, Rectangle

    covariance = np.array(found.pose.covariance, dtype=float).reshape(6, 6)[1:3, 1:3] * 1e12  # um^2
    values, vectors = np.linalg.eigh(covariance)
    angle = rad_to_deg(float(np.arctan2(vectors[1, 1], vectors[0, 1])))
    figure = sheet(340)
    wide, near = figure.subplots(1, 2)
    y, z = m_to_mm(limits.y), m_to_mm(limits.z)
    wide.add_patch(Rectangle((-y, -z), 2 * y, 2 * z, fill=False, color=RED, linestyle="--"))
    wide.plot(m_to_mm(found.offset_y), m_to_mm(found.offset_z), "+", color=BLUE, markersize=14)
    wide.set(xlim=(-1.2 * y, 1.2 * y), ylim=(-1.2 * z, 1.2 * z), aspect="equal")
    wide.set(title="place of the corner; dashed: limits", xlabel="y [mm]", ylabel="z [mm]")
    width, height = 2.0 * SIGMAS * np.sqrt(np.maximum(values[::-1], 0.0))
    near.add_patch(Ellipse((0.0, 0.0), width, height, angle=angle, fill=False, color=BLUE))
    near.plot(0.0, 0.0, "+", color=BLUE, label="found")
    reach = 0.7 * max(width, height)
    if true is not None:
        off = m_to_um(true.offset_y - found.offset_y), m_to_um(true.offset_z - found.offset_z)
        near.plot(*off, "x", color=GREEN, label="true (simulation)")
        reach = max(reach, 1.2 * max(abs(v) for v in off))
    near.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    near.legend()
    near.set(title=f"{SIGMAS:g} standard deviations about it", xlabel="y [um]", ylabel="z [um]")
    return svg(figure)


@styled
def handshake_figure(steps: Sequence[HandshakeStep]) -> str:
    """States of the handshake over time; the time before the first change of state is left out."""
    figure = sheet(60 + 26 * len({s.state for s in steps}))
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
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("since the first state [s]")
    return svg(figure)


@styled
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
    figure = sheet(270)
    axes = figure.add_subplot()
    axes.plot(way[cutting], m_to_mm(size[cutting]), color=GREY, linewidth=1.0, label="executed")
    last = np.flatnonzero(np.diff(motion, append=motion[-1] + 1) != 0)
    ends = [int(i) for i in last if cutting[i] and 0 <= motion[i] < len(targets.motions)]
    reached = [targets.targets[targets.motions[motion[i]].target].deflection.linear for i in ends]
    predicted = [np.linalg.norm([v.x, v.y, v.z]) for v in reached]
    if ends:
        at_targets = m_to_mm(np.array(predicted))
        axes.plot(way[ends], at_targets, ".", color=BLUE, markersize=4, label="predicted at targets")
    axes.legend()
    axes.set(xlabel="way in the wood [m]", ylabel="deflection [mm]")
    return svg(figure)
