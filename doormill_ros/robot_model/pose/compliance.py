"""A diagnosis of poses in the hands of the path generator: pose error and joint springs together."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import vector_from_rotation
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.errors import RobotError
from doormill_ros.robot_model.elastic.compliance import ComplianceModel, StandingSpread
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.robot_model.errors import PoseModelError
from doormill_ros.robot_model.pose.chain import frames, link_transforms
from doormill_ros.robot_model.pose.model import PoseModel, load_pose_model


class PoseErrorCompliance:
    """How far the tool of a loaded robot stands from where the nominal kinematics put it.

    Unlike joint springs it displaces the unloaded robot too. The zero of joint 1, the height of the base and
    the flange frame are those of the nominal model: what a displaced robot or tool would imitate belongs to the
    calibration of the cell (`not_distinguishable_from_placement` of the diagnosis).

    Attributes:
        robot: Name of the robot.
        pose_model: Pose error without load.
        springs: What the load adds.
    """

    def __init__(self, pose_model: PoseModel, springs: ComplianceModel) -> None:
        """Keep both."""
        self.pose_model = pose_model
        self.springs = springs
        self.robot = pose_model.robot

    def deflection(
        self,
        q: FloatArray,
        wrench: FloatArray,
        load_point: FloatArray,
        direction: FloatArray | None = None,
    ) -> FloatArray:
        """Twist of the loaded tool against the nominal pose, as `ComplianceModel.deflection`."""
        return self.standing(q, load_point, direction) + self.springs.deflection(
            q, wrench, load_point, direction
        )

    def standing(
        self, q: FloatArray, load_point: FloatArray, direction: FloatArray | None = None
    ) -> FloatArray:
        """Twist of the unloaded tool against the nominal pose, as `StandingModel.standing`."""
        q = np.atleast_2d(np.asarray(q, dtype=float))
        nominal = frames(link_transforms(self.pose_model.dh, q))[:, -1]
        actual = self.pose_model.flange(q, direction)
        point = np.append(np.asarray(load_point, dtype=float), 1.0)
        shift = ((actual - nominal) @ point)[:, :3]
        turn = vector_from_rotation(actual[:, :3, :3] @ np.swapaxes(nominal[:, :3, :3], 1, 2))
        return np.concatenate([shift, turn], axis=1)

    def standing_spread(self, q: FloatArray, load_point: FloatArray, relative: FloatArray) -> StandingSpread:
        """None: the diagnosis states no spread of what it leaves; shapes as `StandingModel.standing_spread`."""
        return StandingSpread(np.zeros((len(q), 6, 3)), np.zeros(len(q)))


def load_pose_compliance(path: Path) -> PoseErrorCompliance:
    """A pose diagnosis' model.yaml with the joint springs of the robot it names.

    Raises:
        PoseModelError: The file cannot be used, or the project has no description of its robot.
    """
    model = load_pose_model(path)
    try:
        robot = load_robot(model.robot)
    except RobotError as error:
        raise PoseModelError(
            f"{path} corrects the unloaded poses of robot {model.robot!r}, whose joint springs are not described: "
            f"add config/robots/{model.robot}, or use load_pose_model to predict poses without load",
            path=str(path),
        ) from error
    if len(model.dh) != len(robot.dh):
        raise PoseModelError(
            f"{path} describes {len(model.dh)} joints, robot {model.robot!r} has {len(robot.dh)}; "
            "give the model of this robot",
            path=str(path),
        )
    return PoseErrorCompliance(model, JointSpringModel(robot))
