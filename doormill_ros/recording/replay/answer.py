"""What a stage of a run answered, as names and values that can be compared, written down and read back."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph import topic_names
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.frames import quaternion_xyzw
from doormill_ros.localization.gige.errors import NoPictureInTime
from doormill_ros.localization.sensors.sensed_door import DEGREES_OF_FREEDOM, SensedDoor
from doormill_ros.messages.from_message import program_of, sensed_door_of, transform_of
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.toolpath.program import MillingProgram, Motion, Target

Value = bool | int | str | float | list[float]

RECIPE_STAGE = f"/{topic_names.DOOR_RECIPE}"
LOCALIZATION_STAGE = f"/{topic_names.DOOR_LOCALIZATION}"
SENSOR_STAGE = f"/{topic_names.SENSOR_LOCALIZATION}"
TARGETS_STAGE = f"/{topic_names.PATH_TARGETS}"
TARGET_FILE_STAGE = f"/{topic_names.ABB_TARGET_FILE}"
RESULT_STAGE = f"/{topic_names.RUN_RESULT}"
#: In the order in which they follow from each other: the first difference is nearest to its cause.
STAGES = (RECIPE_STAGE, LOCALIZATION_STAGE, SENSOR_STAGE, TARGETS_STAGE, TARGET_FILE_STAGE, RESULT_STAGE)
#: Which code makes what is on a topic.
MAKERS = {
    RECIPE_STAGE: "the recipe database (doormill_ros/recipes)",
    LOCALIZATION_STAGE: "the localizer (doormill_ros/localization)",
    SENSOR_STAGE: "the localizer or a sensor beside it (doormill_ros/localization)",
    TARGETS_STAGE: "path and correction (doormill_ros/toolpath, doormill_ros/correction)",
    TARGET_FILE_STAGE: "the RAPID writer (doormill_ros/abb/target_file)",
    RESULT_STAGE: "the run (doormill_ros/pipeline/course.py)",
}
SAVED = ("version", "author", "created")
ACCEPTED: dict[str, Any] = {"accepted": True, "error_code": 0}
COVARIANCE = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3))  # y, z, rotation in the 6 x 6 matrix


@dataclass(frozen=True)
class Answer:
    """One message of a stage.

    Attributes:
        topic: Full topic name, one of STAGES, below the namespace of one of two robots where it is its own.
        stamp_ns: Stamp of the picture it came from (0: from none) [ns since the epoch].
        values: Compared fields by their path in the message; lists are vectors.
        not_compared: Why the stage was not repeated and counts neither as equal nor as different; empty when
            it was.
    """

    topic: str
    stamp_ns: int
    values: dict[str, Value] = field(default_factory=dict)
    not_compared: str = ""

    @property
    def stage(self) -> str:
        """Which of STAGES, whichever robot's."""
        return stage_of(self.topic)

    @property
    def accepted(self) -> bool:
        """The stage gave a result and no refusal."""
        return bool(self.values.get("accepted", True))

    @property
    def error_code(self) -> int:
        """Code of the refusal, 0 when there was none."""
        code = self.values.get("error_code", 0)
        return code if isinstance(code, int) else 0


def stage_of(topic: str) -> str:
    """The stage that a topic belongs to; empty for one of none."""
    return next((stage for stage in STAGES if topic.endswith(stage)), "")


def of_robot(robot: str, answer: Answer) -> Answer:
    """The answer of one of two robots, in its namespace; of the only one, named "", as it is."""
    return replace(answer, topic=f"/{robot}{answer.topic}") if robot else answer


def refusal(topic: str, stamp_ns: int, code: int, reason: str) -> Answer:
    """The answer of a stage that refused."""
    return Answer(topic, stamp_ns, {"accepted": False, "error_code": code, "reason": reason})


def pictureless(message: Any) -> bool:
    """Whether a localization is what a camera said of a picture that it could not take."""
    return bool(message.error_code == NoPictureInTime.code)


def kept(answer: Answer) -> Answer:
    """What no stage can be asked again."""
    return replace(answer, not_compared="no picture came; only the camera knew why")


def recipe_of(message: Any) -> Answer:
    """What a doormill_interfaces/DoorRecipe answers: of its JSON content all but who saved it when."""
    document = {k: v for k, v in json.loads(message.document).items() if k not in SAVED}
    return Answer(RECIPE_STAGE, 0, _flat({"version": int(message.version), "document": _by_index(document)}))


def localization_of(message: Any) -> Answer:
    """What a doormill_interfaces/DoorLocalization answers."""
    stamp_ns = nanoseconds_of(message.header.stamp)
    if not message.accepted:
        return refusal(LOCALIZATION_STAGE, stamp_ns, int(message.error_code), message.reason)
    return localization_answer(
        stamp_ns,
        transform_of(message.pose.pose),
        DoorOffset(message.offset_y, message.offset_z, message.offset_rotation),
        np.array(message.pose.covariance).reshape(6, 6),
        message.residual,
        message.quality,
    )


def localization_answer(
    stamp_ns: int,
    T_base_door: FloatArray,
    offset: DoorOffset,
    covariance: FloatArray,
    residual: float,
    quality: float,
) -> Answer:
    """A door that was found.

    Args:
        stamp_ns: Of the picture [ns since the epoch].
        T_base_door: Where the door stands, shape (4, 4).
        offset: From its nominal place.
        covariance: Of a whole pose, shape (6, 6), or of y, z and rotation, shape (3, 3) [m, rad].
        residual: Rms distance of the edge points from their lines [m].
        quality: Distance from the limits of refusal, 0..1.
    """
    content = {
        "pose.pose": _pose(T_base_door),
        "offset_y": offset.y,
        "offset_z": offset.z,
        "offset_rotation": offset.rotation,
        **_shared(covariance),
        "residual": float(residual),
        "quality": float(quality),
    }
    return Answer(LOCALIZATION_STAGE, stamp_ns, _flat(ACCEPTED | content))


def _shared(covariance: FloatArray) -> dict[str, float]:
    """Variances, and correlations: of two that hardly go together the covariance is a rest of rounding."""
    shift = 0 if covariance.shape == (6, 6) else 1
    found: dict[str, float] = {}
    for row, column in COVARIANCE:
        number, i, j = 6 * row + column, row - shift, column - shift
        if row == column:
            found[f"pose.covariance[{number}]"] = float(covariance[i, i])
        else:
            size = float(np.sqrt(covariance[i, i] * covariance[j, j]))
            found[f"pose.correlation[{number}]"] = float(covariance[i, j]) / size if size > 0.0 else 0.0
    return found


def sensed_of(message: Any) -> Answer:
    """What a doormill_interfaces/SensorLocalization answers."""
    stamp_ns = nanoseconds_of(message.header.stamp)
    if not message.accepted:
        return refusal(SENSOR_STAGE, stamp_ns, int(message.error_code), message.reason)
    return sensed_answer(stamp_ns, sensed_door_of(message))


def sensed_answer(stamp_ns: int, door: SensedDoor) -> Answer:
    """A door that one of several sensors found; what it does not see of the covariance is left out."""
    seen = np.array(door.sees, dtype=float)
    covariance = (door.covariance * np.outer(seen, seen)).ravel()
    content = {
        "sensor": door.sensor,
        "sees": " ".join(name for name, sees in zip(DEGREES_OF_FREEDOM, door.sees, strict=True) if sees),
        "pose.pose": _pose(door.T_base_door),
        "pose.covariance": covariance,
    }
    return Answer(SENSOR_STAGE, stamp_ns, _flat(ACCEPTED | content))


def targets_of(message: Any) -> Answer:
    """What a doormill_interfaces/TargetArray answers."""
    stamp_ns = nanoseconds_of(message.header.stamp)
    if not message.accepted:
        return refusal(TARGETS_STAGE, stamp_ns, int(message.error_code), message.reason)
    return targets_answer(stamp_ns, program_of(message), message.cycle_time, message.robot_model)


def targets_answer(stamp_ns: int, program: MillingProgram, cycle_time: float, robot_model: str) -> Answer:
    """A program that was generated; `cycle_time` in s."""
    content = {
        "recipe_version": program.recipe_version,
        "targets.length": len(program.targets),
        "motions.length": len(program.motions),
        "robot_model": robot_model,
        **{f"targets[{index}]": _target(target) for index, target in enumerate(program.targets)},
        **{f"motions[{index}]": _motion(motion) for index, motion in enumerate(program.motions)},
        "largest_correction": program.largest_correction,
        "expected_error": program.expected_error,
        "cycle_time": float(cycle_time),
    }
    return Answer(TARGETS_STAGE, stamp_ns, _flat(ACCEPTED | content))


def target_file_answer(stamp_ns: int, data: bytes, sha256: str = "", by_line: bool = True) -> Answer:
    """A RAPID target file.

    Args:
        stamp_ns: Of the picture it came from [ns since the epoch].
        data: Its content; empty where only the checksum is known.
        sha256: That checksum; empty for that of `data`.
        by_line: Compare line by line, not the checksum alone.
    """
    lines = data.decode("ascii", errors="replace").split("\n") if data and by_line else []
    values: dict[str, Value] = {f"line {number}": line for number, line in enumerate(lines, start=1)}
    values["sha256"] = sha256 or hashlib.sha256(data).hexdigest()
    return Answer(TARGET_FILE_STAGE, stamp_ns, values)


def result_answer(success: bool, error_code: int, message: str) -> Answer:
    """How a run ended; what a success says of its timing is not compared."""
    values: dict[str, Value] = {"success": bool(success), "error_code": int(error_code)}
    return Answer(RESULT_STAGE, 0, values if success else {**values, "message": message})


def _target(target: Target) -> dict[str, Any]:
    """Fields of a doormill_interfaces/Target."""
    conf = target.conf
    return {
        "name": target.name,
        "nominal": _pose(target.T_base_tool_nominal),
        "corrected": _pose(target.T_base_tool_corrected),
        "joint_positions": target.q,
        "cf1": conf.cf1,
        "cf4": conf.cf4,
        "cf6": conf.cf6,
        "cfx": conf.cfx,
        "wrench": {"force": target.wrench[:3], "torque": target.wrench[3:]},
        "deflection": {"linear": target.deflection[:3], "angular": target.deflection[3:]},
        "expected_error": target.expected_error,
    }


def _motion(motion: Motion) -> dict[str, Any]:
    """Fields of a doormill_interfaces/Motion."""
    end = motion.last_wrench
    return {
        "kind": motion.kind.value,
        "target": motion.target,
        "via": -1 if motion.via is None else motion.via,
        "speed": float(motion.speed),
        "zone": motion.zone,
        "feature": motion.feature,
        "cutting": motion.cutting,
        "spindle_speed": float(motion.spindle_speed),
        "wrench": {"force": motion.wrench[:3], "torque": motion.wrench[3:]},
        "wrench_end": {"force": end[:3], "torque": end[3:]},
    }


def _pose(T_a_b: FloatArray) -> dict[str, FloatArray]:
    return {"position": T_a_b[:3, 3], "orientation": quaternion_xyzw(T_a_b)}


def _by_index(content: Any) -> Any:
    """JSON content with its lists as mappings from "[0]", "[1]", ...: each entry is compared for itself."""
    if isinstance(content, dict):
        return {key: _by_index(value) for key, value in content.items()}
    if isinstance(content, list):
        return {f"[{index}]": _by_index(value) for index, value in enumerate(content)}
    return content


def _flat(content: Mapping[str, Any]) -> dict[str, Value]:
    """Values by their path; arrays are vectors, what is None is left out."""
    values: dict[str, Value] = {}
    for key, value in content.items():
        if isinstance(value, Mapping):
            for path, inner in _flat(value).items():
                values[f"{key}{path}" if path.startswith("[") else f"{key}.{path}"] = inner
        elif isinstance(value, np.ndarray):
            values[key] = value.astype(float).tolist()
        elif value is not None:
            values[key] = value
    return values
