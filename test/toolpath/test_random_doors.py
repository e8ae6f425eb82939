"""Any valid door: a program whose milled result is right, or a sentence that says why not."""

import importlib.util
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, event, given, settings

from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.milled_part import inspect
from doormill_ros.toolpath.door_plan import whole_door
from doormill_ros.toolpath.errors import PathError
from doormill_ros.toolpath.thesis_path import is_thesis_door


def _load(path):
    spec = importlib.util.spec_from_file_location(f"strategies_of_{path.parent.name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


doors = _load(Path(__file__).with_name("doors.py"))
QUIET = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.function_scoped_fixture]


@settings(max_examples=25, deadline=None, suppress_health_check=QUIET)
@given(doors.doors())
def test_milled_within_five_hundredths_or_refused_with_a_reason(cell, door):
    document, (y, z, rotation) = door
    recipe = Recipe.from_document(document)
    T_base_door = cell.T_base_door(recipe, y, z, rotation)
    try:
        program = cell.program(recipe, T_base_door)
    except PathError as error:
        event(type(error).__name__)
        assert 300 < error.code < 400
        assert error.data["feature"] in {f.id for f in recipe.features}
        assert error.data["feature"] in error.message
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
