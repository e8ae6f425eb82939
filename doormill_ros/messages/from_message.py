"""Messages to domain types by the names of their fields, wherever the messages come from.

Works alike on the classes that ROS generates and on those that a bag brings along, so that a
bag is replayed by what a node computes with.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.inspection import MeasuredDoor
from doormill_ros.cell.summary import TOLERANCE
from doormill_ros.frames import from_xyzw
from doormill_ros.localization.camera import CameraModel
from doormill_ros.localization.errors import BadCameraInfo
from doormill_ros.messages.picture import LARGEST, SMALLEST
from doormill_ros.messages.sensor_window import in_window
from doormill_ros.recipes.documents import parse_json
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.configuration import ConfData
from doormill_ros.toolpath.errors import DoorPoseError
from doormill_ros.toolpath.program import RACK_KINDS, MillingProgram, Motion, MotionKind, Target
from doormill_ros.units import ns_to_s

FARTHEST = 100.0  # m that a door may be away
UNIT = 1e-3  # by which the length of a quaternion may differ from 1
#: Names of the lens model with k1, k2, p1, p2, k3; the second one has more, which have to be zero.
BROWN = ("plumb_bob", "rational_polynomial")
MOST_DISTORTION = 10.0
FOCAL = (0.1, 50.0)  # of the picture's longer side
#: Numbers of doormill_interfaces/Motion.kind.
KINDS = (MotionKind.JOINT, MotionKind.LINEAR, MotionKind.CIRCULAR, MotionKind.ABSOLUTE, *RACK_KINDS)


def nanoseconds_of(stamp: Any) -> int:
    """Nanoseconds since the epoch of a builtin_interfaces/Time."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def seconds_of(stamp: Any) -> float:
    """Seconds since the epoch of a builtin_interfaces/Time."""
    return float(stamp.sec + ns_to_s(stamp.nanosec))


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


def wrench_of(message: Any) -> FloatArray:
    """Shape (6,), force first [N, N m], from a geometry_msgs/Wrench."""
    f, t = message.force, message.torque
    return np.array([f.x, f.y, f.z, t.x, t.y, t.z])


def twist_of(message: Any) -> FloatArray:
    """Shape (6,), translation first [m, rad], from a geometry_msgs/Twist."""
    v, w = message.linear, message.angular
    return np.array([v.x, v.y, v.z, w.x, w.y, w.z])


def camera_of(message: Any, mounted: CameraModel) -> CameraModel:
    """The mounted camera with the intrinsics of a sensor_msgs/CameraInfo, as the pictures with it have them.

    Raises:
        BadCameraInfo: No calibration, one of another lens model than Brown's, or one that no camera has; a part of the
            sensor that it has not.
    """
    _require_size(message)
    k = np.array(message.k, dtype=float).reshape(3, 3)
    _require_matrix(k, message)
    distortion = np.zeros(5)
    distortion[: min(5, len(message.d))] = message.d[:5]
    model, beyond = message.distortion_model, np.asarray(message.d[5:], dtype=float)
    lensless = model == "" and not np.any(message.d)
    if (model not in BROWN and not lensless) or beyond.any():
        raise BadCameraInfo(
            f"the camera info has distortion model {model!r} with {len(message.d)} coefficients, allowed is "
            f"{BROWN[0]} with five; calibrate the camera with that model"
        )
    if not np.abs(distortion).max() <= MOST_DISTORTION:
        raise BadCameraInfo(
            f"the camera info has distortion coefficients up to {np.abs(distortion).max():g}, allowed are "
            f"{MOST_DISTORTION:g}; calibrate the camera again"
        )
    k, size = in_window(k, message)
    return mounted.with_intrinsics(k, distortion, size)


def _require_size(message: Any) -> None:
    sizes = (int(message.width), int(message.height))
    if not all(SMALLEST <= size <= LARGEST for size in sizes):
        raise BadCameraInfo(
            f"the camera info is for {sizes[0]} x {sizes[1]} px, allowed are {SMALLEST} to {LARGEST} px; check the "
            "camera's driver",
            size=sizes,
        )


def _require_matrix(k: FloatArray, message: Any) -> None:
    if not k.any():
        raise BadCameraInfo(
            "the camera info holds no calibration: K is zero; calibrate the camera and let its driver send that"
        )
    size = np.array([message.width, message.height], dtype=float)
    focal, centre = np.array([k[0, 0], k[1, 1]]), k[:2, 2]
    whole = np.isfinite(k).all() and np.array_equal(k[[1, 2, 2, 2], [0, 0, 1, 2]], [0.0, 0.0, 0.0, 1.0])
    near, far = FOCAL[0] * size.max(), FOCAL[1] * size.max()
    focused = whole and bool(((focal >= near) & (focal <= far)).all()) and abs(k[0, 1]) <= 0.1 * focal[0]
    if not focused or not bool(((centre >= 0) & (centre <= size)).all()):
        raise BadCameraInfo(
            f"the camera info has K = {[float(f'{v:.6g}') for v in k.ravel()]}, allowed are focal lengths of "
            f"{near:g} to {far:g} px and a centre inside the picture; calibrate the camera again"
        )


def recipe_of(message: Any) -> Recipe:
    """The recipe of a doormill_interfaces/DoorRecipe, checked again.

    Raises:
        RecipeError: The document in the message is no JSON or not a valid recipe.
    """
    return Recipe.from_document(parse_json(message.document))


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


def gauged_of(message: Any) -> MeasuredDoor:
    """How a door came out, from a doormill_interfaces/DoorInspection: its worst point, whichever way it is off."""
    points = zip(message.feature, map(abs, message.deviation), strict=False)
    return MeasuredDoor.worst(points, TOLERANCE)


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
