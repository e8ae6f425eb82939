"""The library of causes of pose errors: one line a cause."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.causes.joint_backlash import PoseBacklash
from doormill_ros.robot_model.pose.causes.joint_periodic_error import JointPeriodicError
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.joint_wobble import JointWobble
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.causes.session_step import SessionStep
from doormill_ros.robot_model.pose.causes.settling import PoseSettling
from doormill_ros.robot_model.pose.causes.thermal_drift import PoseDrift
from doormill_ros.robot_model.pose.causes.tracker_scale import PoseTrackerScale

LIBRARY: tuple[type[PoseCause], ...] = (
    LinkGeometry,
    JointSag,
    JointPeriodicError,
    JointWobble,
    PoseBacklash,
    PoseDrift,
    PoseSettling,
    SessionStep,
    PoseTrackerScale,
)


def candidates(hints: Hints) -> list[PoseCause]:
    """Every cause at every place where it may act."""
    return [cause for kind in LIBRARY for cause in kind.candidates(hints)]


def build_cause(name: str, where: str, settings: Mapping[str, Any], dh: FloatArray) -> PoseCause:
    """The cause of a model's file; `dh` is the nominal table, shape (J, 4).

    Raises:
        KeyError: A setting is missing.
        ValueError: The library has no such cause of the robot itself.
    """
    for kind in LIBRARY:
        if kind.name == name and kind.of_robot:
            return kind.build(where, settings, dh)
    raise ValueError(f"{name!r} is no cause of a robot's poses")
