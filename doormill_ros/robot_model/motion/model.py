"""What a diagnosis of moving joints leaves behind: how link and motor encoder of each joint differ, and its file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.robot_model.errors import MotionModelError
from doormill_ros.robot_model.model_file import read_model
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.causes.registry import build_cause
from doormill_ros.robot_model.motion.law.ride import ride_of
from doormill_ros.robot_model.motion.law.term import MotionTerm
from doormill_ros.robot_model.motion.view import JointMotion

SCHEMA = "doormill/extended-motion-model/1"


@dataclass(frozen=True, eq=False)
class JointModel:
    """Causes of one joint.

    Attributes:
        joint: Number, 1 to 6.
        stiffness: Of the model that was questioned [N m / rad].
        delay: By which its link encoder is read late [s].
        causes: What was established besides.
        x: Coefficients of each; the height of the wave alone where its phase belongs to the recording.
        laws: What no cause names, with weights, SI.
    """

    joint: int
    stiffness: float
    delay: float = 0.0
    causes: tuple[MotionCause, ...] = ()
    x: tuple[FloatArray, ...] = ()
    laws: tuple[tuple[MotionTerm, FloatArray], ...] = ()

    def residual(
        self,
        motion: JointMotion,
        own: bool = True,
        company: Sequence[JointMotion] = (),
        kept: BoolArray | None = None,
    ) -> FloatArray:
        """Measured less predicted link minus motor angle of a recording, shape (n,) [rad]; 0 beyond its ends.

        Laws act on what was recorded of the other joints in `company`, with their means where that is missing. Samples
        that are not `kept`, shape (n,), decide on no constant and are left at 0.

        The recording's own constants are fitted to it: its offset and, with `own`, where bristles and teeth lay when it
        began and the phase of a scale without an index.
        """
        seen = motion.seen(self.delay)
        rows = seen.recorded if kept is None else seen.recorded & kept
        left = motion.link - motion.motor - seen.predicted
        for cause, x in zip(self.causes, self.x, strict=True):
            columns = cause.columns(seen)
            left = left - columns @ x[: columns.shape[1]]
        rides = (ride_of(motion, company, self.delay),)
        for term, weights in self.laws:
            left = left - term.effect(rides)[:, 0] @ term.from_values(weights, rides)
        if own:
            for cause, x in zip(self.causes, self.x, strict=True):
                columns = cause.own_columns(seen)
                left = left - _own_part(left, columns, rows, float(np.abs(x[0])), not cause.phased)
        return np.where(rows, left - left[rows].mean(), 0.0)


def _own_part(
    left: FloatArray, columns: FloatArray, rows: BoolArray, size: float, at_most: bool
) -> FloatArray:
    """What a recording's own coefficients of a size (or at most of it), fitted to some rows, explain, shape (n,)."""
    if not columns.shape[1]:
        return np.zeros(len(left))
    centred = columns - columns[rows].mean(axis=0)
    own = np.linalg.lstsq(centred[rows], left[rows] - left[rows].mean(), rcond=1e-9)[0]
    length = float(np.linalg.norm(own))
    if length > 0.0 and (length > size or not at_most):
        own = own * size / length
    return np.asarray(centred @ own, dtype=float)


@dataclass(frozen=True, eq=False)
class MotionModel:
    """Published springs and the causes that a diagnosis established.

    Attributes:
        robot: Name of the robot.
        joints: The joints that were recorded.
    """

    robot: str
    joints: tuple[JointModel, ...]

    def of(self, joint: int) -> JointModel:
        """The model of a joint; KeyError where there is none."""
        for model in self.joints:
            if model.joint == joint:
                return model
        raise KeyError(joint)


def model_document(model: MotionModel, source: str) -> dict[str, Any]:
    """The content of model.yaml."""
    return {
        "schema": SCHEMA,
        "robot": model.robot,
        "source": source,
        "joints": [
            {
                "joint": one.joint,
                "stiffness": float(one.stiffness),
                "link_encoder_late": float(one.delay),
                "causes": [
                    {
                        "cause": cause.name,
                        "where": cause.where,
                        **cause.settings,
                        "coefficients": [float(v) for v in x],
                    }
                    for cause, x in zip(one.causes, one.x, strict=True)
                ],
                **({"laws": [term.document(weights) for term, weights in one.laws]} if one.laws else {}),
            }
            for one in model.joints
        ],
    }


def load_motion_model(path: Path) -> MotionModel:
    """Read a model.yaml of a diagnosis of moving joints, or the folder that holds it.

    Raises:
        MotionModelError: It cannot be read or used.
    """
    return read_model(path, SCHEMA, MotionModelError, _model)


def _model(document: dict[str, Any]) -> MotionModel:
    return MotionModel(str(document["robot"]), tuple(_joint(entry) for entry in document["joints"]))


def _joint(entry: dict[str, Any]) -> JointModel:
    causes: Sequence[MotionCause] = [
        build_cause(one["cause"], str(one["where"]), one) for one in entry["causes"]
    ]
    x = tuple(np.array(one["coefficients"], dtype=float) for one in entry["causes"])
    stiffness, delay = float(entry["stiffness"]), float(entry["link_encoder_late"])
    if not all(np.all(np.isfinite(part)) and part.size for part in (*x, np.array([stiffness, delay]))):
        raise ValueError("a coefficient is no finite number")
    laws = tuple(MotionTerm.read(one) for one in entry.get("laws", ()))
    return JointModel(int(entry["joint"]), stiffness, delay, tuple(causes), x, laws)
