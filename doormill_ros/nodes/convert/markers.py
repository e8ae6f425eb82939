"""A milling program as markers for RViz and Foxglove."""

from __future__ import annotations

import numpy as np
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from doormill_ros.toolpath.program import MillingProgram

NOMINAL = ColorRGBA(r=0.55, g=0.55, b=0.55, a=1.0)
CORRECTED = ColorRGBA(r=0.10, g=0.45, b=0.85, a=1.0)
CORRECTION = ColorRGBA(r=0.90, g=0.35, b=0.10, a=1.0)
EXAGGERATION = 100.0  # corrections are tenths of a millimetre on a door of metres


def _marker(header: Header, name: str, kind: int, width: float, colour: ColorRGBA) -> Marker:
    marker = Marker(header=header, ns=name, id=0, type=kind, action=Marker.ADD, color=colour)
    marker.pose.orientation.w = 1.0
    marker.scale = Vector3(x=width, y=width, z=width)
    return marker


def _point(p: np.ndarray) -> Point:
    return Point(x=float(p[0]), y=float(p[1]), z=float(p[2]))


def program_markers(program: MillingProgram, header: Header) -> MarkerArray:
    """Nominal and corrected path through the targets in execution order, corrections exaggerated.

    Args:
        program: What to show.
        header: Frame base_link and the stamp of the picture.
    """
    clear = Marker(header=header, action=Marker.DELETEALL)
    nominal = _marker(header, "nominal path", Marker.LINE_STRIP, 0.001, NOMINAL)
    corrected = _marker(header, "corrected path", Marker.LINE_STRIP, 0.001, CORRECTED)
    corrections = _marker(header, "correction x 100", Marker.LINE_LIST, 0.0015, CORRECTION)
    for motion in program.motions:
        for index in ([] if motion.via is None else [motion.via]) + [motion.target]:
            target = program.targets[index]
            p_nominal, p_corrected = target.T_base_tool_nominal[:3, 3], target.T_base_tool_corrected[:3, 3]
            nominal.points.append(_point(p_nominal))
            corrected.points.append(_point(p_corrected))
            corrections.points.append(_point(p_nominal))
            corrections.points.append(_point(p_nominal + EXAGGERATION * (p_corrected - p_nominal)))
    return MarkerArray(markers=[clear, nominal, corrected, corrections])
