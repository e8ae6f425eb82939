"""What a stage of a run answered, as names and values that can be compared, written down and read back."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import quaternion_xyzw
from doormill_ros.toolpath.program import MillingProgram

Value = bool | int | str | float | list[float]

RECIPE = "/door/recipe"
LOCALIZATION = "/door/localization"
TARGETS = "/path/targets"
TARGET_FILE = "/abb/target_file"
RESULT = "/run/result"
#: In the order in which they follow from each other: the first difference is nearest to its cause.
STAGES = (RECIPE, LOCALIZATION, TARGETS, TARGET_FILE, RESULT)
#: Which code makes what is on a topic.
MAKERS = {
    RECIPE: "the recipe database (doormill_ros/recipes)",
    LOCALIZATION: "the localizer (doormill_ros/localization)",
    TARGETS: "path and correction (doormill_ros/toolpath, doormill_ros/correction)",
    TARGET_FILE: "the RAPID writer (doormill_ros/abb/target_file.py)",
    RESULT: "the run (doormill_ros/nodes/mill_door.py)",
}
SAVED = ("version", "author", "created")
COVARIANCE = ((1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3))  # y, z, rotation in the 6 x 6 matrix


@dataclass(frozen=True)
class Answer:
    """One message of a stage.

    Attributes:
        topic: Full topic name, one of STAGES.
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
    def accepted(self) -> bool:
        """The stage gave a result and no refusal."""
        return bool(self.values.get("accepted", True))


def refusal(topic: str, stamp_ns: int, code: int, reason: str) -> Answer:
    """The answer of a stage that refused."""
    return Answer(topic, stamp_ns, {"accepted": False, "error_code": code, "reason": reason})


def recipe_answer(document: dict[str, Any], version: int) -> Answer:
    """A recipe as the database gave it; of its JSON content all but who saved it when."""
    values: dict[str, Value] = {"version": int(version)}
    _flatten(values, "document", {k: v for k, v in document.items() if k not in SAVED})
    return Answer(RECIPE, 0, values)


def _flatten(values: dict[str, Value], name: str, content: Any) -> None:
    if isinstance(content, dict):
        for key, value in content.items():
            _flatten(values, f"{name}.{key}", value)
    elif isinstance(content, list):
        for index, value in enumerate(content):
            _flatten(values, f"{name}[{index}]", value)
    elif content is not None:
        values[name] = content


def _pose(values: dict[str, Value], name: str, T_a_b: FloatArray) -> None:
    values[f"{name}.position"] = T_a_b[:3, 3].tolist()
    values[f"{name}.orientation"] = quaternion_xyzw(T_a_b).tolist()


def localization_answer(
    stamp_ns: int,
    T_base_door: FloatArray,
    offset: Any,
    covariance: FloatArray,
    residual: float,
    quality: float,
) -> Answer:
    """A door that was found; `covariance` has shape (6, 6) or, of y, z and rotation, (3, 3)."""
    values: dict[str, Value] = {"accepted": True, "error_code": 0}
    _pose(values, "pose.pose", T_base_door)
    values |= {"offset_y": offset.y, "offset_z": offset.z, "offset_rotation": offset.rotation}
    shift = 0 if covariance.shape == (6, 6) else 1
    for row, column in COVARIANCE:
        values[f"pose.covariance[{6 * row + column}]"] = float(covariance[row - shift, column - shift])
    values |= {"residual": float(residual), "quality": float(quality)}
    return Answer(LOCALIZATION, stamp_ns, values)


def targets_answer(stamp_ns: int, program: MillingProgram, cycle_time: float, robot_model: str) -> Answer:
    """A program that was generated."""
    values: dict[str, Value] = {"accepted": True, "error_code": 0, "recipe_version": program.recipe_version}
    values |= {"targets.length": len(program.targets), "motions.length": len(program.motions)}
    values["robot_model"] = robot_model
    for index, target in enumerate(program.targets):
        name = f"targets[{index}]"
        values[f"{name}.name"] = target.name
        _pose(values, f"{name}.nominal", target.T_base_tool_nominal)
        _pose(values, f"{name}.corrected", target.T_base_tool_corrected)
        values[f"{name}.joint_positions"] = np.asarray(target.q, dtype=float).tolist()
        for axis in ("cf1", "cf4", "cf6", "cfx"):
            values[f"{name}.{axis}"] = int(getattr(target.conf, axis))
        _six(values, f"{name}.wrench", ("force", "torque"), target.wrench)
        _six(values, f"{name}.deflection", ("linear", "angular"), target.deflection)
    for index, motion in enumerate(program.motions):
        name = f"motions[{index}]"
        values[f"{name}.kind"] = motion.kind.value
        values[f"{name}.target"] = motion.target
        values[f"{name}.via"] = -1 if motion.via is None else motion.via
        values[f"{name}.speed"] = float(motion.speed)
        values[f"{name}.zone"] = motion.zone
        values[f"{name}.feature"] = motion.feature
        values[f"{name}.cutting"] = motion.cutting
        values[f"{name}.spindle_speed"] = float(motion.spindle_speed)
        _six(values, f"{name}.wrench", ("force", "torque"), motion.wrench)
    values["largest_correction"] = program.largest_correction
    values["cycle_time"] = float(cycle_time)
    return Answer(TARGETS, stamp_ns, values)


def _six(values: dict[str, Value], name: str, halves: tuple[str, str], vector: FloatArray) -> None:
    values[f"{name}.{halves[0]}"] = np.asarray(vector[:3], dtype=float).tolist()
    values[f"{name}.{halves[1]}"] = np.asarray(vector[3:], dtype=float).tolist()


def target_file_answer(stamp_ns: int, data: bytes, sha256: str) -> Answer:
    """A RAPID target file, line by line; without content only its checksum is compared."""
    lines = data.decode("ascii", errors="replace").split("\n") if data else []
    values: dict[str, Value] = {f"line {number}": line for number, line in enumerate(lines, start=1)}
    values["sha256"] = sha256
    return Answer(TARGET_FILE, stamp_ns, values)
