"""Messages to domain types by the names of their fields, wherever the messages come from.

Works alike on the classes that ROS generates and on those that a bag brings along, so that a
bag is replayed by what a node computes with.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.frames import from_xyzw
from doormill_ros.localization.sensors.sensed_door import SensedDoor
from doormill_ros.recipes.documents import parse_json
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.configuration import ConfData
from doormill_ros.toolpath.errors import DoorPoseError
from doormill_ros.toolpath.program import RACK_KINDS, MillingProgram, Motion, MotionKind, Target

FARTHEST = 100.0  # m that a door may be away
UNIT = 1e-3  # by which the length of a quaternion may differ from 1
#: Numbers of doormill_interfaces/Motion.kind.
KINDS = (MotionKind.JOINT, MotionKind.LINEAR, MotionKind.CIRCULAR, MotionKind.ABSOLUTE, *RACK_KINDS)


def transform_of(pose: Any) -> FloatArray:
    """T_a_b, shape (4, 4), from a geometry_msgs/Pose of b in a."""
    p, q = pose.position, pose.orientation
    return from_xyzw(np.array([p.x, p.y, p.z]), np.array([q.x, q.y, q.z, q.w]))


def door_pose_of(pose: Any) -> FloatArray:
    """T_base_door, shape (4, 4), from a geometry_msgs/Pose that came from somebody else.

    Raises:
        DoorPoseError: It holds values that are not finite, or no rotation.
    """
    p, q = pose.position, pose.orientation
    values = np.array([p.x, p.y, p.z, q.x, q.y, q.z, q.w])
    near = bool((np.abs(values) < FARTHEST).all())  # false for what is no number
    if not near or not abs(float(np.linalg.norm(values[3:])) - 1.0) < UNIT:
        raise DoorPoseError(
            f"the door's pose is {[float(f'{v:.6g}') for v in values]}, allowed are numbers below {FARTHEST:g} "
            "and a quaternion of length 1; look at who sends door/pose"
        )
    return transform_of(pose)


def positions_of(points: Iterable[Any]) -> FloatArray:
    """Coordinates of geometry_msgs/Points or Vector3s, shape (n, 3)."""
    return np.array([(p.x, p.y, p.z) for p in points], dtype=float).reshape(-1, 3)


def transforms_of(poses: list[Any]) -> FloatArray:
    """T_a_b, shape (n, 4, 4), all at once: one by one the calls cost more than the arithmetic."""
    if not poses:
        return np.empty((0, 4, 4))
    points, turns = [pose.position for pose in poses], [pose.orientation for pose in poses]
    return from_xyzw(
        np.array([(p.x, p.y, p.z) for p in points]), np.array([(q.x, q.y, q.z, q.w) for q in turns])
    )


def wrenches_of(messages: Iterable[Any]) -> FloatArray:
    """Shape (n, 6), force first [N, N m], from geometry_msgs/Wrenches."""
    return _pairs((w.force, w.torque) for w in messages)


def twists_of(messages: Iterable[Any]) -> FloatArray:
    """Shape (n, 6), translation first [m, rad], from geometry_msgs/Twists."""
    return _pairs((t.linear, t.angular) for t in messages)


def _pairs(vectors: Iterable[tuple[Any, Any]]) -> FloatArray:
    """Coordinates of pairs of geometry_msgs/Vector3, shape (n, 6); all at once, as in `transforms_of`."""
    return np.array([(a.x, a.y, a.z, b.x, b.y, b.z) for a, b in vectors], dtype=float).reshape(-1, 6)


def recipe_of(message: Any) -> Recipe:
    """The recipe of a doormill_interfaces/DoorRecipe, checked again.

    Raises:
        RecipeError: The document in the message is no JSON or not a valid recipe.
    """
    return Recipe.from_document(parse_json(message.document))


def sensed_door_of(message: Any) -> SensedDoor:
    """Where a sensor has the door, from an accepted doormill_interfaces/SensorLocalization.

    Raises:
        DoorPoseError: Its pose is none.
    """
    return SensedDoor(
        sensor=str(message.sensor),
        T_base_door=door_pose_of(message.pose.pose),
        covariance=np.array(message.pose.covariance, dtype=float).reshape(6, 6),
        sees=tuple(bool(seen) for seen in message.sees),
    )


def inspection_of(message: Any) -> MeasuredDoor:
    """How a door came out, from a doormill_interfaces/MilledDoor; one without features was not measured."""
    found = ((feature.feature, float(feature.corrected_max)) for feature in message.features)
    return MeasuredDoor.worst(found, float(message.tolerance))


def gauged_of(message: Any) -> MeasuredDoor:
    """How a door came out, from a doormill_interfaces/DoorInspection: its worst point, whichever way it is off."""
    points = zip(message.feature, map(abs, message.deviation), strict=False)
    return MeasuredDoor.worst(points, TOLERANCE)


def program_of(message: Any) -> MillingProgram:
    """The milling program of an accepted doormill_interfaces/TargetArray."""
    nominal = transforms_of([t.nominal for t in message.targets])
    corrected = transforms_of([t.corrected for t in message.targets])
    q = np.array([t.joint_positions for t in message.targets], dtype=float)
    loads = wrenches_of(t.wrench for t in message.targets)
    deflection = twists_of(t.deflection for t in message.targets)
    targets = tuple(
        Target(
            name=t.name,
            T_base_tool_nominal=nominal[i],
            T_base_tool_corrected=corrected[i],
            q=q[i],
            conf=ConfData(int(t.cf1), int(t.cf4), int(t.cf6), int(t.cfx)),
            wrench=loads[i],
            deflection=deflection[i],
            expected_error=float(getattr(t, "expected_error", 0.0)),  # older bags lack it
        )
        for i, t in enumerate(message.targets)
    )
    begin = wrenches_of(m.wrench for m in message.motions)
    # Bags of constant wrenches have no end of them.
    end = wrenches_of(getattr(m, "wrench_end", m.wrench) for m in message.motions)
    constant = (begin == end).all(axis=1)
    motions = tuple(
        Motion(
            kind=KINDS[m.kind],
            target=int(m.target),
            via=None if m.via < 0 else int(m.via),
            speed=float(m.speed),
            zone=m.zone,
            feature=m.feature,
            cutting=bool(m.cutting),
            wrench=begin[i],
            spindle_speed=float(m.spindle_speed),
            wrench_end=None if constant[i] else end[i],
        )
        for i, m in enumerate(message.motions)
    )
    # Bags of programs without ways have none of these fields.
    points = tuple(np.array(p.joint_positions, dtype=float) for p in getattr(message, "points", ()))
    home = np.array(getattr(message, "home", ()), dtype=float)
    escapes = tuple(range(int(e.first), int(e.last) + 1) for e in getattr(message, "escapes", ()))
    return MillingProgram(
        message.door_id,
        int(message.recipe_version),
        targets,
        motions,
        points,
        home if home.shape == (JOINTS,) else None,
        escapes,
    )
