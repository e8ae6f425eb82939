"""A recording of moving joints as a lab hands it over: encoders on both sides of the gears, and torques."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.measurements.documents.schemas import MOTION_SET
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.documents.si_units import JOINT_ANGLE, check_cells
from doormill_ros.measurements.documents.trial_table import TrialTable
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.sets.sample_times import even_times
from doormill_ros.robot_model.motion.quiet_torque import quiet_torque
from doormill_ros.robot_model.motion.view import JointMotion
from doormill_ros.units import DEG

#: Numbers of joints that a robot may have.
JOINTS = (6, 7)
NOISE = ("link", "motor", "torque")
STANDS = 1e-6  #: range of a joint that stands, at most [rad]
SLOPE = 0.1  #: by which a degree for a radian may be off and still be that


@dataclass(frozen=True, eq=False)
class MotionSet:
    """One recording; arrays are read-only.

    Attributes:
        path: Folder the set was read from.
        robot: Name of the robot.
        source: Where the data come from.
        rate: Samples per second, as stated; the recorder's own clock may differ a little.
        joints: Numbers of the joints with a link encoder.
        motions: What was recorded of each of them.
        line: Line of each sample in samples.csv, shape (n,).
        commanded: Angles of all joints, shape (n, J) [rad]; J is 7 where joint 7 has a link encoder, else 6.
        noise: Standard deviation of link encoder, motor encoder [rad] and torque [N m]; None where not stated.
    """

    path: Path
    robot: str
    source: str
    rate: float
    joints: tuple[int, ...]
    motions: tuple[JointMotion, ...]
    line: IntArray
    commanded: FloatArray
    noise: tuple[float | None, float | None, float | None]

    def __len__(self) -> int:
        return len(self.line)

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.path.resolve().name


def read_motion_set(folder: Path) -> MotionSet:
    """Read set.yaml and samples.csv.

    Raises:
        DataFileError: A file is missing or is no text.
        SetDescriptionError: set.yaml lacks a key or holds a value not allowed.
        TrialTableError: samples.csv lacks a column or holds what is no number or no radians.
        MotionTableError: Its times are uneven or do not fit the rate, or it is too short.
    """
    document = SetDocument(folder / "set.yaml")
    document.check_schema(MOTION_SET)
    document.check_spelling(("source", "noise"))
    document.check_spelling(("gear_ratio", "joint_stiffness", "motor_inertia"), "model")
    rate = document.number("rate", positive=True)
    joints = _joints(document)
    ratio, stiffness = (
        _of_joints(document, joints, "model", key) for key in ("gear_ratio", "joint_stiffness")
    )
    inertia: tuple[float, ...] = ()
    if "motor_inertia" in document.get("model"):
        inertia = tuple(_of_joints(document, joints, "model", "motor_inertia").tolist())
    own = [name for kind in ("m", "l", "tau") for name in (f"{kind}{joint}" for joint in joints)]
    commanded = [f"r{joint}" for joint in range(1, max(joints[-1], JOINTS[0]) + 1)]
    table = TrialTable(folder / "samples.csv", ["t", *own, *commanded])
    time = even_times(table, table.numbers("t"), rate)
    values = {name: table.numbers(name) for name in own}
    commanded_angles = table.block(commanded)
    angles = [name for name in own if not name.startswith("tau")]
    check_cells(table, angles, np.column_stack([values[name] for name in angles]), JOINT_ANGLE)
    check_cells(table, commanded, commanded_angles, JOINT_ANGLE)
    _check_motion(table, joints, values, commanded_angles)
    for array in (time, *values.values()):
        array.setflags(write=False)
    return MotionSet(
        path=folder,
        robot=document.text("robot"),
        source=document.text("source") if "source" in document.data else "",
        rate=rate,
        joints=joints,
        motions=tuple(
            JointMotion(
                joint,
                time,
                values[f"m{joint}"],
                values[f"l{joint}"],
                torque,
                float(ratio[i]),
                float(stiffness[i]),
                noise_left,
                inertia[i] if inertia else None,
            )
            for i, joint in enumerate(joints)
            for torque, noise_left in [quiet_torque(values[f"tau{joint}"])]
        ),
        line=np.array(table.lines),
        commanded=commanded_angles,
        noise=_noise(document),
    )


def _check_motion(
    table: TrialTable, joints: Sequence[int], values: Mapping[str, FloatArray], commanded: FloatArray
) -> None:
    """Refuse a recording in which nothing moves, and encoders that tell degrees of what was commanded in radians."""
    if not any(np.ptp(values[f"m{joint}"]) > STANDS for joint in joints):
        raise table.fail(0, f"m{joints[0]}", "is as in all rows, as is every joint: record joints that move")
    for name, joint in ((f"{kind}{joint}", joint) for kind in "ml" for joint in joints):
        sent = commanded[:, joint - 1] - commanded[:, joint - 1].mean()
        slope = float(sent @ values[name]) / max(float(sent @ sent), 1e-30)
        if abs(slope * DEG - 1.0) < SLOPE:
            raise table.fail(
                0,
                name,
                f"changes by {slope:.1f} where r{joint} changes by 1 rad: are these degrees? write radians",
            )


def check_same_joints(first: MotionSet, other: MotionSet) -> None:
    """Recordings given together have to question the same model of the same joints.

    Raises:
        SetMixError: They do not.
    """
    model, theirs = (
        [(motion.joint, motion.gear_ratio, motion.stiffness) for motion in data.motions]
        for data in (first, other)
    )
    for name, mine, found in (("robot", first.robot, other.robot), ("model", model, theirs)):
        if mine != found:
            raise SetMixError(
                f"{other.path / 'set.yaml'}: line 1, column 1: {name} is not the one in {first.path}; "
                "sets given together need the same"
            )


def check_same_noise(first: MotionSet, other: MotionSet) -> None:
    """Recordings diagnosed together are weighed by one noise.

    Raises:
        SetMixError: They state another, or only one of them states any.
    """
    if first.noise != other.noise:
        raise SetMixError(
            f"{other.path / 'set.yaml'}: line 1, column 1: noise is {_told(other)}, but {_told(first)} in "
            f"{first.path}; sets diagnosed together need the same, others can be checked"
        )


def _told(data: MotionSet) -> str:
    names = ("link", "motor", "torque")
    stated = [f"{n} {v:g}" for n, v in zip(names, data.noise, strict=True) if v is not None]
    return ", ".join(stated) or "not stated"


def _joints(document: SetDocument) -> tuple[int, ...]:
    joints = document.get("joints")
    whole = isinstance(joints, list) and all(type(joint) is int for joint in joints)
    if not whole or not joints or sorted(set(joints)) != joints or joints[0] < 1 or joints[-1] > JOINTS[-1]:
        raise document.fail(
            ("joints",), f"is {joints!r}, allowed are ascending numbers from 1 to {JOINTS[-1]}"
        )
    return tuple(joints)


def _of_joints(document: SetDocument, joints: tuple[int, ...], *keys: str) -> FloatArray:
    """One number for each of the joints, from a list of just these or of all six or seven, shape (len(joints),)."""
    listed = document.get(*keys)
    every = isinstance(listed, list) and len(listed) in JOINTS and len(listed) >= joints[-1]
    values = document.vector(len(listed) if every else len(joints), *keys)
    if np.any(values <= 0.0):
        raise document.fail(keys, f"is {values.tolist()}, allowed are positive numbers")
    return values[[joint - 1 for joint in joints]] if every else values


def _noise(document: SetDocument) -> tuple[float | None, float | None, float | None]:
    stated = document.data.get("noise") or {}
    if not isinstance(stated, dict):
        raise document.fail(("noise",), "needs link, motor and torque")
    if stated:
        document.check_spelling(NOISE, "noise")
    link, motor, torque = (
        document.number("noise", name, positive=True) if name in stated else None for name in NOISE
    )
    return link, motor, torque
