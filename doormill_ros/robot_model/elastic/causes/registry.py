"""The library of causes: one line a cause."""

from __future__ import annotations

from collections.abc import Iterable

from doormill_ros.robot_model.elastic.causes.base_compliance import BaseCompliance
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.causes.joint_backlash import DisplacementBacklash
from doormill_ros.robot_model.elastic.causes.joint_cross_compliance import JointCrossCompliance
from doormill_ros.robot_model.elastic.causes.joint_friction import JointFriction
from doormill_ros.robot_model.elastic.causes.joint_hardening import JointHardening
from doormill_ros.robot_model.elastic.causes.joint_offset import JointOffset
from doormill_ros.robot_model.elastic.causes.joint_stiffness import JointStiffness
from doormill_ros.robot_model.elastic.causes.link_bending import LinkBending
from doormill_ros.robot_model.elastic.causes.process_force import ProcessForce, ProcessForceDirection
from doormill_ros.robot_model.elastic.causes.reflector_position import ReflectorPosition
from doormill_ros.robot_model.elastic.causes.thermal_drift import DisplacementDrift
from doormill_ros.robot_model.elastic.causes.tool_bending import ToolBending
from doormill_ros.robot_model.elastic.causes.tool_compliance import ToolCompliance
from doormill_ros.robot_model.elastic.causes.tracker_frame_rotation import TrackerFrameRotation
from doormill_ros.robot_model.elastic.causes.tracker_scale import TrackerScale
from doormill_ros.robot_model.elastic.causes.wrench_frame_rotation import WrenchFrameRotation
from doormill_ros.robot_model.elastic.causes.wrench_gain import WrenchGain

LIBRARY: tuple[type[ElasticCause], ...] = (
    JointStiffness,
    DisplacementBacklash,
    JointHardening,
    JointFriction,
    JointCrossCompliance,
    LinkBending,
    BaseCompliance,
    ToolCompliance,
    WrenchFrameRotation,
    WrenchGain,
    TrackerFrameRotation,
    TrackerScale,
    DisplacementDrift,
    ReflectorPosition,
    JointOffset,
)

#: What a process alone can show; no loading test does.
CUTTING: tuple[type[ElasticCause], ...] = (ProcessForce, ProcessForceDirection, ToolBending)


def candidates(reflectors: Iterable[str]) -> list[ElasticCause]:
    """Every cause at every place, for a test with these reflectors."""
    reflectors = tuple(reflectors)
    return [cause for kind in LIBRARY for cause in kind.candidates(reflectors)]


def build_cause(name: str, where: str, variant: str = "") -> ElasticCause:
    """The cause of a name at a place.

    Raises:
        KeyError: The library has no such cause.
    """
    for kind in (*LIBRARY, *CUTTING):
        if kind.name == name and (kind.places is None or where in kind.places) and variant in kind.variants:
            return kind.build(where, variant)
    raise KeyError(f"{name} at {where}")
