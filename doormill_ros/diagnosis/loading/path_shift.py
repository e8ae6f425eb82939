"""What a diagnosis changes on a part: how far the extended model sends the tool elsewhere, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.loading.laws import sized_laws
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis
from doormill_ros.errors import DoormillError
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, SizedCause
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.units import m_to_mm

#: The door on which the models are compared: the thesis' tall one, where the arm reaches far.
DOOR = "thesis_1350_0deg"
#: Two causes that the data cannot part may send the tool this far apart, a tenth of the tolerance of a hinge [m].
PART = 5e-5


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


def path_shift(diagnosis: LoadingDiagnosis) -> PathShift | None:
    """Send both models through the path generator; None where neither cause nor law acts in the robot."""
    causes = [SizedCause(f.cause, f.values) for f in diagnosis.findings if f.cause.of_robot]
    causes += [law for law in sized_laws(diagnosis) if law.cause.of_robot]
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
        used = {i for i in (motion.target, motion.via) if i is not None} if motion.cutting else set()
        for index in used:
            target = extended.targets[index]
            if target.name in before:
                away = float(np.linalg.norm(target.T_base_tool_corrected[:3, 3] - before[target.name]))
                largest[motion.feature] = max(largest.get(motion.feature, 0.0), away)
    worst = max(largest, key=lambda feature: largest[feature])
    return PathShift(
        DOOR,
        largest,
        f"On the door {DOOR} the extended model sends the tool up to {m_to_mm(largest[worst]):.3f} mm elsewhere than "
        f"the joint springs do (feature {worst}); that error stays on the part as long as the path knows the springs "
        "only.",
    )


def choices(diagnosis: LoadingDiagnosis) -> dict[str, list[SizedCause]]:
    """What acts in the robot with every way in which the findings may be read, by the words for it; ours first."""
    case = diagnosis.problem.case
    named = [finding.cause for finding in diagnosis.findings]
    found = {
        " and ".join(map(repr, named)): [
            SizedCause(f.cause, f.values) for f in diagnosis.findings if f.cause.of_robot
        ]
    }
    equals = [equal.model for finding in diagnosis.findings for equal in finding.equals]
    for model in (model for model in equals if model is not None):
        # Of a model with an equal in it: what stands in no other model for anything unnamed or not believed.
        members = [
            cause
            for cause in model.members
            if cause.named and (cause in named or cause not in diagnosis.best.members)
        ]
        found[" and ".join(map(repr, members))] = [
            SizedCause(cause, cause.values(model.theta[model.part(cause)], case))
            for cause in members
            if cause.of_robot
        ]
    return found


def paths_apart(
    robot: str, dh: FloatArray, stiffness: FloatArray, models: Mapping[str, Sequence[SizedCause]]
) -> tuple[tuple[str, str], float]:
    """The two models that send the tool farthest apart, and how far [m]; 0 where there is no path to compare.

    Args:
        robot: Name of the robot.
        dh: Its table, shape (6, 4).
        stiffness: Joint springs of the model in question, shape (6,) [N m / rad].
        models: Causes that act by the words for them.
    """
    names = list(models)
    worst, apart = (names[0], names[-1]), 0.0
    if len(models) < 2:
        return worst, apart
    try:
        paths = {name: _targets(_program(robot, dh, stiffness, causes)) for name, causes in models.items()}
    except DoormillError:
        return worst, apart  # `path_shift` says why there is none
    for one, two in combinations(paths, 2):
        both = paths[one].keys() & paths[two].keys()
        away = max(float(np.linalg.norm(paths[one][name] - paths[two][name])) for name in both)
        if away > apart + 1e-9:
            worst, apart = (one, two), away
    return worst, apart


def doubt(diagnosis: LoadingDiagnosis) -> str:
    """Why the path gets no extended model, in a sentence; empty where all readings send the tool the same way."""
    data = diagnosis.problem.data
    (one, two), apart = paths_apart(data.robot, data.dh, data.joint_stiffness, choices(diagnosis))
    if apart <= PART:
        return ""
    return (
        f"model.yaml is the unchanged model: these data cannot tell {one} from {two}, and on the door {DOOR} the two "
        f"would send the tool up to {m_to_mm(apart):.3f} mm apart, allowed are {m_to_mm(PART):.2f} mm."
    )


def _targets(program: MillingProgram) -> dict[str, FloatArray]:
    """Corrected position of every target of a cut by its name, shape (3,) [m]."""
    used = {
        i
        for motion in program.motions
        if motion.cutting
        for i in (motion.target, motion.via)
        if i is not None
    }
    return {program.targets[i].name: program.targets[i].T_base_tool_corrected[:3, 3] for i in sorted(used)}


def _program(
    robot: str, dh: FloatArray, stiffness: FloatArray, causes: Sequence[SizedCause]
) -> MillingProgram:
    recipe = load_recipe(DOOR)
    setup = replace(load_setup(robot), model=ExtendedComplianceModel(robot, dh, stiffness, causes))
    return plan(recipe, setup.layout.T_base_door(recipe.width, recipe.thickness), setup).program
