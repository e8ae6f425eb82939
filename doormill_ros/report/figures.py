"""Figures of the report, as inline SVG or as pictures in data URLs."""

from __future__ import annotations

import base64
import io
import re
import zlib
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from doormill_ros.messages.from_message import picture_of
from doormill_ros.operator.picture import MEDIA_TYPE, encode_picture
from doormill_ros.units import m_to_mm


def svg(figure: Figure) -> str:
    """The figure as an <svg> element."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", bbox_inches="tight")
    text = buffer.getvalue()
    # Several figures share the page: their ids must not be taken for each other's.
    prefix = f"f{zlib.crc32(text.encode()):08x}-"
    text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}", text)
    return text[text.index("<svg") :]


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


def deviation_figure(milled: Any) -> str:
    """Deviation along the contour of every feature, with and without correction."""
    features = [f for f in milled.features if len(f.arc_length)]
    figure = Figure(figsize=(8.0, 2.0 * max(1, len(features))))
    for index, feature in enumerate(features):
        axes = figure.add_subplot(len(features), 1, index + 1)
        along = m_to_mm(np.asarray(feature.arc_length))
        axes.plot(along, m_to_mm(np.asarray(feature.uncorrected)), color="#999999", label="uncorrected")
        axes.plot(along, m_to_mm(np.asarray(feature.corrected)), color="#1a73c8", label="corrected")
        axes.axhline(m_to_mm(milled.tolerance), color="#d04a1a", linewidth=0.8, linestyle="--")
        axes.axhline(-m_to_mm(milled.tolerance), color="#d04a1a", linewidth=0.8, linestyle="--")
        axes.set_title(f"{feature.feature} ({feature.kind})", loc="left", fontsize=9)
        axes.set_ylabel("deviation [mm]", fontsize=8)
        axes.tick_params(labelsize=8)
        if index == 0:
            axes.legend(fontsize=8, loc="upper right")
    figure.axes[-1].set_xlabel("along the contour [mm]; dashed: tolerance", fontsize=8)
    figure.tight_layout()
    return svg(figure)


def correction_figure(targets: Any) -> str:
    """Predicted deflection and applied correction at each target."""
    nominal = np.array([_position(t.nominal) for t in targets.targets])
    corrected = np.array([_position(t.corrected) for t in targets.targets])
    linear = [t.deflection.linear for t in targets.targets]
    predicted = np.array([[v.x, v.y, v.z] for v in linear])
    figure = Figure(figsize=(8.0, 2.6))
    axes = figure.add_subplot()
    for axis, (name, colour) in enumerate(zip("xyz", ("#d04a1a", "#1a73c8", "#3a9a3a"), strict=True)):
        axes.plot(m_to_mm((corrected - nominal)[:, axis]), color=colour, label=f"correction {name}")
        axes.plot(m_to_mm(predicted[:, axis]), color=colour, linestyle=":", label=f"deflection {name}")
    axes.set_xlabel("target", fontsize=8)
    axes.set_ylabel("[mm]", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.legend(fontsize=7, ncols=3)
    return svg(figure)


def _position(pose: Any) -> list[float]:
    return [pose.position.x, pose.position.y, pose.position.z]
