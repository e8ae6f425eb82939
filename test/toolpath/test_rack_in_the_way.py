"""A rack that stands where a shipped door's ways would lead: the judge sees it, and the planner goes round."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.resources import resource
from doormill_ros.robot.inverse import inverse_near
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judge import judge
from support.file_run import run_file
from support.judged_doors import RUN_ID, rigid

DOOR = load_recipe("standard_door")
SETUP = rigid(load_setup())
T_BASE_DOOR = SETUP.layout.T_base_door(DOOR.width, DOOR.thickness)


def milled(setup):
    """What the robot does to the door."""
    program = plan(DOOR, T_BASE_DOOR, setup).program
    return run_file(render_target_file(program, RUN_ID).decode("ascii"))


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """The cell's file with the second place of its rack where the mill is half-way home from the last feature."""
    executed, _ = milled(replace(SETUP, layout=replace(SETUP.layout, rack=None)))
    ended = int(np.flatnonzero(executed.feature != "")[-1])
    q = executed.q[(ended + len(executed)) // 2]
    content = yaml.safe_load(resource("config/cell.yaml").read_text())
    rack = content["rack"]
    pose = Kinematics(SETUP.robot).forward(q)
    pose[:3, 3] -= rack["depth"] * pose[:3, 2]
    (front,) = inverse_near(SETUP.robot, pose[None], q)
    rack["places"][1]["front"] = front.tolist()
    path = tmp_path_factory.mktemp("moved") / "cell.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def test_the_judge_sees_the_tool_that_is_driven_through(moved):
    """Ways of a planner that knows of no rack."""
    executed, turned = milled(replace(SETUP, layout=replace(SETUP.layout, rack=None)))
    verdict = judge(DOOR, T_BASE_DOOR, executed, load_cell(cell=moved), turned)
    assert ("spindle", "tool rack_mill_12") in {(t.body, t.obstacle) for t in verdict.touches}


def test_the_planner_goes_round_it(moved):
    executed, turned = milled(replace(SETUP, layout=load_layout(moved)))
    verdict = judge(DOOR, T_BASE_DOOR, executed, load_cell(cell=moved), turned)
    assert verdict.error is None, verdict.sentence
