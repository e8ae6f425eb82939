"""The robot model that a diagnosis leaves behind: joint springs plus the causes it established."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.config import read_document
from doormill_ros.frames import rotate_wrench, rotation_from_vector
from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.robot.errors import RobotError
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.displacement import Displacement, StandingDisplacement, displacement_of
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause, Setup, index
from doormill_ros.robot_model.elastic.causes.joint_backlash import DisplacementBacklash
from doormill_ros.robot_model.elastic.causes.joint_stiffness import JointStiffness
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.compliance import ComplianceModel
from doormill_ros.robot_model.elastic.joint_springs import spring_twist
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce, ModelKnowledge, measured_force_of
from doormill_ros.robot_model.elastic.law.term import LawTerm
from doormill_ros.robot_model.elastic.load_case import LoadCase, build_load_case, largest_of
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.robot_model.gravity.model import SaggingModel
from doormill_ros.robot_model.gravity.weights import torques
from doormill_ros.robot_model.model_file import MODEL_FILE, inside, model_path, read_model, schema_of
from doormill_ros.robot_model.pose.compliance import PoseErrorCompliance, load_pose_compliance
from doormill_ros.robot_model.pose.model import SCHEMA as POSE_SCHEMA
from doormill_ros.robot_model.warmth.growth import ThermalGrowth, growth_of

SCHEMA = "doormill/extended-model/1"


@dataclass(frozen=True, eq=False)
class SizedCause:
    """A cause and the values of its parameters in a row, SI units; their standard deviations where they are known."""

    cause: ElasticCause
    values: FloatArray
    std: FloatArray | None = None


class ExtendedComplianceModel:
    """Joint springs, established causes and laws without a name as a `ComplianceModel`.

    Attributes:
        robot: Name of the robot.
        joint_stiffness: Springs of the model that was questioned, shape (6,) [N m / rad].
        causes: What was established; those that are not of the robot are kept for the record only.
        laws: What no cause names, likewise.
        force: How well doors told the process force; None where none did.
        place: Where the unloaded tool stands; None: where it is sent. `standing_model` makes it part of a model.
        growth: How it comes forward as the cell warms up; None where no doors told. `grown` makes it part of a model.
    """

    def __init__(
        self,
        robot: str,
        dh: FloatArray,
        joint_stiffness: FloatArray,
        causes: Sequence[SizedCause],
        laws: Sequence[SizedCause] = (),
        force: MeasuredForce | None = None,
        place: Displacement | None = None,
        growth: ThermalGrowth | None = None,
    ) -> None:
        """Keep robot, springs, causes, laws, how well the force is known, where the tool stands and how it grows."""
        self.robot = robot
        self.joint_stiffness = np.array(joint_stiffness, dtype=float)
        self.causes = tuple(causes)
        self.laws = tuple(laws)
        self.force = force
        self.place = place
        self.growth = growth
        self._kinematics = Kinematics(dh)

    def springs_of_joints(self) -> FloatArray:
        """Springs with what causes established of them, shape (6,) [N m / rad]."""
        springs = self.joint_stiffness.copy()
        for sized in self.causes:
            if isinstance(sized.cause, JointStiffness):
                springs[index(sized.cause.where)] = sized.values[0]
        return springs

    def knowledge(self) -> ModelKnowledge:
        """What the diagnosis measured, as `KnowingModel.knowledge`."""
        springs, gaps = np.full(6, np.nan), np.zeros(6)
        for sized in self.causes:
            if sized.std is None:
                continue
            if isinstance(sized.cause, JointStiffness):
                springs[index(sized.cause.where)] = sized.std[0]
            elif isinstance(sized.cause, DisplacementBacklash):
                gaps[index(sized.cause.where)] = sized.std[0]
        return ModelKnowledge(self.springs_of_joints(), springs, gaps, self.force)

    def felt(self, q: FloatArray, wrench: FloatArray) -> FloatArray:
        """As large and turned as the causes have it, as `KnowingModel.felt`."""
        return self._felt(self._setup(), q, wrench)

    @property
    def remembers(self) -> bool:
        """As `compliance.remembers`: springs alone do not."""
        return bool(self._acting())

    def _acting(self) -> list[SizedCause]:
        """What displaces the robot beside its springs."""
        return [s for s in (*self.causes, *self.laws) if s.cause.of_robot and s.cause.stage == "robot"]

    def _setup(self) -> Setup:
        setup = Setup()
        for sized in (*self.causes, *self.laws):
            if sized.cause.of_robot and sized.cause.stage == "setup":
                sized.cause.setup(setup, _theta(sized))
        return setup

    def _felt(self, setup: Setup, q: FloatArray, wrench: FloatArray) -> FloatArray:
        if setup.process_angle:
            axis = self._kinematics.forward(q)[:, :3, 2]
            wrench = rotate_wrench(rotation_from_vector(setup.process_angle * axis), wrench)
        felt: FloatArray = setup.wrench_gain * wrench
        return felt

    def deflection(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Twist of the loaded tool, as `ComplianceModel.deflection`.

        A joint whose last motion is unknown (0) gets half of its backlash: the expected value. A law whose driver
        is unknown gets its mean over the test it comes from.
        """
        q = np.atleast_2d(np.asarray(q, dtype=float))
        wrench = np.broadcast_to(np.asarray(wrench, dtype=float), (len(q), 6))
        setup = self._setup()
        turned, felt = q + setup.joint_offset, self._felt(setup, q, wrench)
        twist = spring_twist(self._kinematics.jacobian(turned, load_point), felt, self.joint_stiffness)
        acting = self._acting()
        if not acting:
            return twist
        case = build_load_case(
            self._kinematics,
            turned,
            felt,
            np.asarray(load_point, dtype=float),
            direction=None if direction is None else np.broadcast_to(direction, q.shape),
            joint_stiffness=self.joint_stiffness,
        )
        carrying = self._carrying(case)
        for sized in acting:
            # What weight makes of the springs is where the unloaded tool stands; of a gap nobody tells it apart.
            felt_by = carrying if isinstance(sized.cause, DisplacementBacklash) else case
            share = sized.cause.hidden_state(felt_by)
            part = sized.cause.twist(felt_by, sized.cause.from_values(sized.values, felt_by))
            twist = twist + (part if share is None else share[:, None] * part)
        return twist

    def _carrying(self, case: LoadCase) -> LoadCase:
        """The loads with the weight that doors told of: both decide against which flank a joint lies."""
        if self.place is None or not self.place.mass:
            return case
        torque = case.torque + torques(self._kinematics, case.q, [self.place.weight])
        return replace(case, torque=torque, largest_torque=largest_of(torque), cache={})


def _theta(sized: SizedCause) -> FloatArray:
    """Fitted numbers, shape (p,), of a cause before the elasticity: they hang on no load."""
    return sized.cause.from_values(sized.values, None)  # type: ignore[arg-type]


def load_compliance_model(path_or_name: str | Path) -> ExtendedComplianceModel | PoseErrorCompliance:
    """A compliance model from a diagnosis' model.yaml (or its folder), or a robot's own joint springs.

    The model of a pose diagnosis is taken with the joint springs of the robot it names.

    Args:
        path_or_name: model.yaml, a folder that holds one, or the name of a robot.

    Raises:
        ExtendedModelError: No such file or robot, or the file cannot be used.
        PoseModelError: The same of a pose diagnosis, or its robot has no description here.
    """
    path = model_path(Path(path_or_name))
    if not path.is_file():
        try:
            robot = load_robot(path_or_name)
        except RobotError as error:
            raise ExtendedModelError(
                f"{path_or_name} is neither a {MODEL_FILE} nor a robot: {error.message}",
                path=str(path_or_name),
            ) from error
        return _own_springs(robot)
    if schema_of(read_document(path, ExtendedModelError)) == POSE_SCHEMA:
        return load_pose_compliance(path)
    return read_model(path, SCHEMA, ExtendedModelError, lambda document: _model(document, path))


def _model(document: dict[str, Any], path: Path) -> ExtendedComplianceModel:
    with inside("robot"):
        robot = load_robot(str(document["robot"]))
    with inside("joint_stiffness"):
        stiffness = np.array(document["joint_stiffness"], dtype=float)
    causes = _entries(document["causes"], "causes", _sized)
    laws = _entries(document.get("laws", []), "laws", _sized_law)
    if stiffness.shape != (6,) or not np.all(stiffness > 0.0):
        raise ExtendedModelError(
            f"{path} has joint_stiffness {document['joint_stiffness']}, allowed are 6 positive numbers [N m / rad]",
            path=str(path),
        )
    with inside("measured_force"):
        force = measured_force_of(document["measured_force"]) if "measured_force" in document else None
    with inside("standing"):
        place = displacement_of(document["standing"]) if "standing" in document else None
    with inside("thermal_growth"):
        growth = growth_of(document["thermal_growth"]) if "thermal_growth" in document else None
    return ExtendedComplianceModel(robot.name, robot.dh, stiffness, causes, laws, force, place, growth)


def unknown_on_path(model: ComplianceModel) -> tuple[str, ...]:
    """Where a path does not know what drives a law of the robot, one sentence each."""
    if not isinstance(model, ExtendedComplianceModel):
        return ()
    laws = [law.cause for law in model.laws if isinstance(law.cause, LawTerm) and law.cause.of_robot]
    return tuple(
        f"{law.where} hangs on {law.driver}, which no path knows: its mean over the test stands for it"
        for law in laws
        if not law.drives.of_path
    )


def load_model_of(robot: Robot, path_or_name: str | Path = "") -> ComplianceModel:
    """A compliance model of the robot that mills: what `load_compliance_model` finds, if it is of that robot.

    Args:
        robot: The robot in the cell.
        path_or_name: As for `load_compliance_model`; empty: the robot's own joint springs.

    Raises:
        ExtendedModelError: As `load_compliance_model`, or the model is of a robot with other lengths.
        PoseModelError: As `load_compliance_model`.
    """
    if not path_or_name or str(path_or_name) == robot.name:
        return _own_springs(robot)
    model = load_compliance_model(path_or_name)
    if model.robot != robot.name and not np.allclose(load_robot(model.robot).dh, robot.dh):
        raise ExtendedModelError(
            f"{path_or_name} is a model of {model.robot}, the cell mills with {robot.name}; give a diagnosis of this "
            "robot, or correct the robot in config/cell.yaml",
            path=str(path_or_name),
        )
    return standing_model(robot, model) if isinstance(model, ExtendedComplianceModel) else model


def standing_model(robot: Robot, model: ExtendedComplianceModel) -> ComplianceModel:
    """A model with where its unloaded tool stands; the model itself where that is where it was sent."""
    if model.place is None:
        return model
    return SaggingModel(model, StandingDisplacement(robot, model.springs_of_joints(), model.place))


def _own_springs(robot: Robot) -> ExtendedComplianceModel:
    """What a robot's description says of it, nothing added."""
    return ExtendedComplianceModel(robot.name, robot.dh, robot.stiffness, ())


def _entries(entries: Any, place: str, build: Callable[[dict[str, Any]], SizedCause]) -> list[SizedCause]:
    with inside(place):
        if not isinstance(entries, list):
            raise ValueError(f"it is {entries!r:.80}, allowed is a list")
    built = []
    for i, entry in enumerate(entries):
        with inside(f"{place}.{i}"):
            built.append(build(entry))
    return built


def _sized_law(entry: dict[str, Any]) -> SizedCause:
    return _sized(entry) if "cause" in entry else SizedCause(*LawTerm.read(entry))


def _sized(entry: dict[str, Any]) -> SizedCause:
    cause = build_cause(entry["cause"], entry["where"], entry.get("variant", ""))
    std = _row(cause, entry["std"]) if "std" in entry else None
    if std is not None and np.any(std < 0.0):
        raise ValueError(f"std of {cause!r} has a negative number, allowed are 0 and more")
    return SizedCause(cause, _row(cause, entry["parameters"]), std)


def _row(cause: ElasticCause, named: dict[str, Any]) -> FloatArray:
    values = []
    for parameter in cause.parameters:
        part = np.atleast_1d(np.asarray(named[parameter.name], dtype=float))
        if part.shape != (parameter.size,) or not np.all(np.isfinite(part)):
            raise ValueError(f"{parameter.name} of {cause!r} needs {parameter.size} finite numbers")
        values.append(part)
    return np.concatenate(values)
