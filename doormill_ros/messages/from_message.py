"""Messages to domain types by the names of their fields, wherever the messages come from.

Works alike on the classes that ROS generates and on those that a bag brings along, so that a
bag is replayed by what a node computes with.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.cell.inspection import MeasuredDoor
from doormill_ros.frames import from_xyzw
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.errors import BadPicture
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.configuration import ConfData
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target

CHANNELS = {"mono8": 1, "8UC1": 1, "rgb8": 3, "bgr8": 3}
GREY = {"rgb8": np.array([0.299, 0.587, 0.114]), "bgr8": np.array([0.114, 0.587, 0.299])}
#: Numbers of doormill_interfaces/Motion.kind.
KINDS = (MotionKind.JOINT, MotionKind.LINEAR, MotionKind.CIRCULAR, MotionKind.ABSOLUTE)


def nanoseconds_of(stamp: Any) -> int:
    """Nanoseconds since the epoch of a builtin_interfaces/Time."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def seconds_of(stamp: Any) -> float:
    """Seconds since the epoch of a builtin_interfaces/Time."""
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def transform_of(pose: Any) -> FloatArray:
    """T_a_b, shape (4, 4), from a geometry_msgs/Pose of b in a."""
    p, q = pose.position, pose.orientation
    return from_xyzw(np.array([p.x, p.y, p.z]), np.array([q.x, q.y, q.z, q.w]))


def transforms_of(poses: list[Any]) -> FloatArray:
    """T_a_b, shape (n, 4, 4), all at once: one by one the calls cost more than the arithmetic."""
    if not poses:
        return np.empty((0, 4, 4))
    points, turns = [pose.position for pose in poses], [pose.orientation for pose in poses]
    return from_xyzw(
        np.array([(p.x, p.y, p.z) for p in points]), np.array([(q.x, q.y, q.z, q.w) for q in turns])
    )


def wrench_of(message: Any) -> FloatArray:
    """Shape (6,), force first [N, N m], from a geometry_msgs/Wrench."""
    f, t = message.force, message.torque
    return np.array([f.x, f.y, f.z, t.x, t.y, t.z])


def twist_of(message: Any) -> FloatArray:
    """Shape (6,), translation first [m, rad], from a geometry_msgs/Twist."""
    v, w = message.linear, message.angular
    return np.array([v.x, v.y, v.z, w.x, w.y, w.z])


def picture_of(message: Any) -> ByteArray:
    """Grey picture, shape (height, width) uint8, from a sensor_msgs/Image.

    Raises:
        BadPicture: An encoding other than mono8, 8UC1, rgb8 or bgr8, or too few bytes.
    """
    channels = CHANNELS.get(message.encoding)
    if channels is None:
        raise BadPicture(
            f"picture has encoding {message.encoding!r}, allowed are {', '.join(CHANNELS)}; "
            "set the camera driver to mono8",
            encoding=message.encoding,
        )
    data = np.frombuffer(message.data, dtype=np.uint8)
    if message.step < message.width * channels or data.size < message.height * message.step:
        raise BadPicture(
            f"picture of {message.width} x {message.height} pixels came with {data.size} bytes in rows of "
            f"{message.step}, needed are {message.height * message.width * channels}; check the camera driver",
            size=int(data.size),
        )
    rows = data[: message.height * message.step].reshape(message.height, message.step)
    rows = rows[:, : message.width * channels]
    if channels == 1:
        return np.ascontiguousarray(rows)
    colour = rows.reshape(message.height, message.width, 3)
    grey: FloatArray = colour @ GREY[message.encoding] + 0.5
    return grey.astype(np.uint8)


def camera_of(message: Any, mounted: CameraModel) -> CameraModel:
    """The mounted camera with the intrinsics of a sensor_msgs/CameraInfo."""
    distortion = np.zeros(5)
    distortion[: min(5, len(message.d))] = message.d[:5]
    k = np.array(message.k, dtype=float).reshape(3, 3)
    return mounted.with_intrinsics(k, distortion, (int(message.width), int(message.height)))


def recipe_of(message: Any) -> Recipe:
    """The recipe of a doormill_interfaces/DoorRecipe, checked again.

    Raises:
        RecipeError: The document in the message is not a valid recipe.
    """
    return Recipe.from_document(json.loads(message.document))


def _wrench_end(motion: Any) -> FloatArray | None:
    """Where it differs from the beginning, shape (6,) [N, N m]; bags of constant wrenches do not have it."""
    end = getattr(motion, "wrench_end", None)
    if end is None:
        return None
    values = wrench_of(end)
    return None if np.array_equal(values, wrench_of(motion.wrench)) else values


def inspection_of(message: Any) -> MeasuredDoor:
    """How a door came out, from a doormill_interfaces/MilledDoor; one without features was not measured."""
    found = ((feature.feature, float(feature.corrected_max)) for feature in message.features)
    return MeasuredDoor.worst(found, float(message.tolerance))


def program_of(message: Any) -> MillingProgram:
    """The milling program of an accepted doormill_interfaces/TargetArray."""
    nominal = transforms_of([t.nominal for t in message.targets])
    corrected = transforms_of([t.corrected for t in message.targets])
    targets = tuple(
        Target(
            name=t.name,
            T_base_tool_nominal=nominal[i],
            T_base_tool_corrected=corrected[i],
            q=np.array(t.joint_positions, dtype=float),
            conf=ConfData(int(t.cf1), int(t.cf4), int(t.cf6), int(t.cfx)),
            wrench=wrench_of(t.wrench),
            deflection=twist_of(t.deflection),
            expected_error=float(getattr(t, "expected_error", 0.0)),  # older bags lack it
        )
        for i, t in enumerate(message.targets)
    )
    motions = tuple(
        Motion(
            kind=KINDS[m.kind],
            target=int(m.target),
            via=None if m.via < 0 else int(m.via),
            speed=float(m.speed),
            zone=m.zone,
            feature=m.feature,
            cutting=bool(m.cutting),
            wrench=wrench_of(m.wrench),
            spindle_speed=float(m.spindle_speed),
            wrench_end=_wrench_end(m),
        )
        for m in message.motions
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
