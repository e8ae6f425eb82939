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

JOINTS = tuple(f"joint {k}" for k in range(1, 7))
LINKS = tuple(f"link {k}" for k in range(1, 7))

#: Class, its places (None: the names of the reflectors) and its variants.
LIBRARY: tuple[tuple[type[ElasticCause], tuple[str, ...] | None, tuple[str, ...]], ...] = (
    (JointStiffness, JOINTS, ("",)),
    (DisplacementBacklash, JOINTS, ("",)),
    (JointHardening, JOINTS, ("",)),
    (JointFriction, JOINTS, ("",)),
    (JointCrossCompliance, JOINTS, ("",)),
    (LinkBending, LINKS, ("",)),
    (BaseCompliance, ("base",), ("", "two axes")),
    (ToolCompliance, ("flange",), ("", "two axes")),
    (WrenchFrameRotation, ("sensor",), ("",)),
    (WrenchGain, ("sensor",), ("",)),
    (TrackerFrameRotation, ("tracker",), ("",)),
    (TrackerScale, ("tracker",), ("",)),
    (DisplacementDrift, ("cell",), ("",)),
    (ReflectorPosition, None, ("",)),
    (JointOffset, JOINTS, ("",)),
)

#: The same of what a process alone can show; no loading test does.
CUTTING: tuple[tuple[type[ElasticCause], tuple[str, ...] | None, tuple[str, ...]], ...] = (
    (ProcessForce, ("tool",), ("",)),
    (ProcessForceDirection, ("tool",), ("",)),
    (ToolBending, ("tool",), ("",)),
)


def candidates(reflectors: Iterable[str]) -> list[ElasticCause]:
    """Every cause at every place, for a test with these reflectors."""
    reflectors = tuple(reflectors)
    found: list[ElasticCause] = []
    for kind, places, variants in LIBRARY:
        for where in reflectors if places is None else places:
            for variant in variants:
                found.append(kind(where, variant) if variant else kind(where))  # type: ignore[call-arg]
    return found


def build_cause(name: str, where: str, variant: str = "") -> ElasticCause:
    """The cause of a name at a place.

    Raises:
        KeyError: The library has no such cause.
    """
    for kind, places, variants in (*LIBRARY, *CUTTING):
        if kind.name == name and (places is None or where in places) and variant in variants:
            return kind(where, variant) if variant else kind(where)  # type: ignore[call-arg]
    raise KeyError(f"{name} at {where}")
