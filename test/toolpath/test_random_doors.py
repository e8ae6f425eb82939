"""Any valid door: a program whose milled result is right, or a sentence that says why not."""

import importlib.util
import os
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, event, given, settings

from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.inverse import inverse
from doormill_ros.simulation.milled_part import inspect
from doormill_ros.toolpath.door_plan import whole_door
from doormill_ros.toolpath.errors import AirMoveError, ConfigurationChangeError, JointSpeedError, PathError
from doormill_ros.toolpath.thesis_path import is_thesis_door


def _load(path):
    spec = importlib.util.spec_from_file_location(f"strategies_of_{path.parent.name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


doors = _load(Path(__file__).with_name("doors.py"))
EXAMPLES = int(os.environ.get("DOORMILL_DOORS", "10"))  # more of them: DOORMILL_DOORS=500 pytest ...
QUIET = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.function_scoped_fixture]


def generated(cell, recipe, T_base_door):
    try:
        return cell.program(recipe, T_base_door), None
    except PathError as refusal:
        return None, refusal


def cause_is_there(cell, recipe, T_base_door, refusal):
    """Ask the inverse kinematics, pose by pose, whether the feature really cannot be served."""
    feature = recipe.feature(refusal.data["feature"])
    box = [
        s * np.array([feature.shape.width, feature.shape.length]) / 2
        for s in ([1, 1], [1, -1], [-1, 1], [-1, -1])
    ]
    depths = (-0.08, 0.0, feature.cut_depth(recipe.size))
    good = []
    for x, y in (*box, (0.0, 0.0)):
        for depth in depths:
            T = T_base_door @ feature.T_door_tool(recipe.size, x, y, depth)
            q = inverse(cell.robot, T @ np.linalg.inv(cell.layout.T_flange_tool))
            # Room for the margins: 1 degree of the limits, 3 of the wrist; a little more than they.
            low, high = cell.robot.lower + 0.03, cell.robot.upper - 0.03
            ok = ((q > low) & (q < high)).all(axis=1) & (np.abs(np.sin(q[:, 4])) > 0.07)
            good.append(ok.any())
    return not all(good) or isinstance(refusal, ConfigurationChangeError | AirMoveError | JointSpeedError)


@settings(
    max_examples=EXAMPLES, deadline=None, suppress_health_check=QUIET, phases=[Phase.explicit, Phase.generate]
)
@given(doors.doors())
def test_milled_within_five_hundredths_or_refused_with_a_reason(cell, door):
    document, (y, z, rotation) = door
    recipe = Recipe.from_document(document)
    T_base_door = cell.T_base_door(recipe, y, z, rotation)
    program, refusal = generated(cell, recipe, T_base_door)
    if refusal is not None:
        event(type(refusal).__name__)
        assert 300 < refusal.code < 400
        assert refusal.data["feature"] in {f.id for f in recipe.features}
        assert refusal.data["feature"] in refusal.message
        assert cause_is_there(cell, recipe, T_base_door, refusal), refusal.message
        return
    event("milled")
    for target in program.targets:
        T_base_tool = cell.kinematics.forward(target.q) @ cell.layout.T_flange_tool
        assert np.abs(T_base_tool - target.T_base_tool_corrected).max() < 1e-8
        assert np.all((target.q > cell.robot.lower) & (target.q < cell.robot.upper))
    executed = cell.execute(program, cell.springs)
    part = inspect(recipe, T_base_door, executed)
    limit = 3e-4 if is_thesis_door(whole_door(recipe)) else 5e-5
    for result in part.features:
        assert result.milled
        assert result.max_deviation < limit, result.feature
        assert result.uncleared < 1e-9
        if limit == 5e-5:
            assert np.abs(result.floor).max() < limit
