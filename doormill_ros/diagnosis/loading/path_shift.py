"""What a diagnosis changes on a part: how far the extended model sends the tool elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.layout import DoorOffset, load_layout
from doormill_ros.diagnosis.loading.diagnosis import Diagnosis
from doormill_ros.errors import DoormillError
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.toolpath.program import MillingProgram

#: The door on which the models are compared: the thesis' tall one, where the arm reaches far.
DOOR = "thesis_1350_0deg"


@dataclass(frozen=True)
class PathShift:
    """Correction by the extended model against that by the joint springs alone.

    Attributes:
        door: Recipe that both were asked to mill.
        largest: Largest distance between the corrected positions of one target by feature [m].
        sentence: The same in words.
    """

    door: str
    largest: dict[str, float]
    sentence: str


def path_shift(diagnosis: Diagnosis) -> PathShift | None:
    """Send both models through the path generator; None where no cause acts in the robot."""
    causes = [SizedCause(f.cause, f.values) for f in diagnosis.findings if f.cause.of_robot]
    if not causes:
        return None
    data = diagnosis.problem.data
    try:
        springs, extended = (
            _program(data.robot, data.dh, data.joint_stiffness, acting) for acting in ([], causes)
        )
    except DoormillError as error:
        return PathShift(DOOR, {}, f"The door {DOOR} cannot be milled by this robot: {error.message}")
    before = {target.name: target.T_base_tool_corrected[:3, 3] for target in springs.targets}
    largest: dict[str, float] = {}
    for motion in extended.motions:
        for index in {motion.target, motion.via} - {None} if motion.cutting else ():
            target = extended.targets[index]
            if target.name in before:
                away = float(np.linalg.norm(target.T_base_tool_corrected[:3, 3] - before[target.name]))
                largest[motion.feature] = max(largest.get(motion.feature, 0.0), away)
    worst = max(largest, key=lambda feature: largest[feature])
    return PathShift(
        DOOR,
        largest,
        f"On the door {DOOR} the extended model sends the tool up to {1e3 * largest[worst]:.3f} mm elsewhere than the "
        f"joint springs do (feature {worst}); that error stays on the part as long as the path knows the springs only.",
    )


def _program(robot: str, dh: FloatArray, stiffness: FloatArray, causes: list[SizedCause]) -> MillingProgram:
    layout, recipe = load_layout(), load_recipe(DOOR)
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))
    model = ExtendedComplianceModel(robot, dh, stiffness, causes)
    return generate_program(recipe, T_base_door, layout, load_robot(robot), model)
