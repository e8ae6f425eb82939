"""Figures of the pages that follow from several values at once; named by `test/figures.yaml`."""

from __future__ import annotations

import re

from doormill_ros.abb.handshake.state import HandshakeTimeouts
from doormill_ros.cell.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.recording.replay.tolerance import tolerance_of
from support.page_figures import number_of
from support.source_tree import ROOT

TIMEOUTS = HandshakeTimeouts()
POSE, ANGLE = tolerance_of("pose.pose.position"), tolerance_of("pose.pose.orientation")
COVARIANCE, RESIDUAL = tolerance_of("pose.covariance[0]"), tolerance_of("residual")
TARGET, JOINTS = tolerance_of("targets[0].position"), tolerance_of("targets[0].joint_positions")
BENT, TURNED = tolerance_of("deflection.linear"), tolerance_of("deflection.angular")
FORCE, TORQUE = tolerance_of("wrench.force"), tolerance_of("wrench.torque")
#: Of the doors in the table of docs/localization.md [m].
THIN, MIDDLE, THICK = 0.03, 0.05, 0.1


def _distance(thickness: float) -> float:
    return load_layout().rear_face_x - thickness - number_of("config/camera.yaml#mounting.x")


def _pixel(thickness: float) -> float:
    k = load_camera().k
    return _distance(thickness) * float(1.0 / k[0, 0] + 1.0 / k[1, 1]) / 2.0


#: From the camera to the face, and a pixel of the face, mean of both directions [m].
THIN_DISTANCE, MIDDLE_DISTANCE, THICK_DISTANCE = map(_distance, (THIN, MIDDLE, THICK))
THIN_PIXEL, MIDDLE_PIXEL, THICK_PIXEL = map(_pixel, (THIN, MIDDLE, THICK))


def axis_from_hinge_edge() -> float:
    """Where the optical axis meets the wood [m]."""
    return number_of("config/camera.yaml#mounting.slider_y") - load_layout().centre_y


def axis_above_bottom_edge() -> float:
    """Where the optical axis meets the wood [m]."""
    return number_of("config/camera.yaml#mounting.z") - load_layout().bottom_z


def seen_further_in_y() -> float:
    """By how much a door of 50 mm seems to stand further in y, a unit of thickness."""
    return axis_from_hinge_edge() / MIDDLE_DISTANCE


def seen_further_in_z() -> float:
    """The same in z."""
    return axis_above_bottom_edge() / MIDDLE_DISTANCE


def remembered_runs() -> float:
    """Run ids that the robot's program keeps."""
    text = (ROOT / "rapid" / "DoorLink.mod").read_text(encoding="utf-8")
    (number,) = re.findall(r"PERS string seenRuns\{(\d+)\}", text)
    return float(number)
