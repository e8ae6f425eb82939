"""Every shipped door on the strict controller: nothing refused, the time as told, milled as the recipe says."""

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.program import Program
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.records.process import module_process
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.toolpath.door_checks import check_door
from support.rapid_bench import arm, controller  # noqa: F401

SHIPPED = shipped_recipes()


@pytest.mark.parametrize("name", SHIPPED)
def test_the_strict_controller_mills_it_in_the_time_that_was_told(name, cell, arm, controller):  # noqa: F811
    """From the request for the path to the robot at home with the door milled, reading and spindle included."""
    recipe = SHIPPED[name]
    T_base_door = cell.placed(recipe)
    program = cell.program(recipe, T_base_door)
    robot = controller(process=module_process(program), truth=TruthRobot(arm.dh), limits=ControllerLimits())
    (robot.home / "Hei2.txt").write_bytes(render_target_file(program, "run-1"))
    robot.run()
    assert [entry for entry in robot.event_log if entry.kind != "information"] == []
    told = check_door(program, recipe, cell.robot).time
    assert told == pytest.approx(robot.now(), rel=0.05)
    if recipe.program is Program.GENERAL:
        part = inspect(recipe, T_base_door, robot.executed_path())
        assert [result.feature for result in part.features] == [feature.id for feature in recipe.features]
        for result in part.features:
            assert result.milled
            assert result.max_deviation < 5e-5, result.feature
            assert np.abs(result.floor).max() < 5e-5
            assert result.uncleared < 1e-9
