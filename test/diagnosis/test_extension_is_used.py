"""From a loading test to the milled door: a hidden backlash costs less once the diagnosis is in the path."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.program import Program
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.toolpath.generate import generate_program
from doormill_ros.tools.diagnose import main
from support import execute as _execute
from support.doors import exactly_known

BACKLASH = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 1e-4, "crossing": 20.0}}


class Reality:
    """The truth robot, asked in the way a compliance model is asked."""

    def __init__(self, robot):
        self.truth = TruthRobot(robot.dh, [BACKLASH], robot.stiffness)

    def deflection(self, q, wrench, load_point, direction=None):
        still, loaded = self.truth.forward(q), self.truth.deflected(q, wrench, load_point, direction)
        shift = ((loaded - still) @ np.append(load_point, 1.0))[:, :3]
        turn = Rotation.from_matrix(loaded[:, :3, :3] @ still[:, :3, :3].transpose(0, 2, 1)).as_rotvec()
        return np.concatenate([shift, turn], axis=1)


@pytest.fixture(scope="module")
def milled(tmp_path_factory, dh):
    """Deviations on the part, millimetres: with joint springs alone, and with the diagnosed model."""
    from support.truth.loading_test import draw_plan, write_loading_test

    folder = tmp_path_factory.mktemp("gain")
    layout = load_layout()
    robot = load_robot(layout.robot)
    rng = np.random.default_rng(61)
    plan = draw_plan(rng, dh, 120, 15)
    plan = type(plan)(**{**vars(plan), "stiffness": np.array(robot.stiffness)})
    write_loading_test(folder / "set", plan, [BACKLASH], rng)
    assert main(["--data", str(folder / "set"), "--out", str(folder / "out"), "--quiet"]) == 0
    # Springs and forces are taken as exact, and as many targets as they ask for: the model alone makes the difference.
    recipe = load_recipe("thesis_1350_0deg")
    recipe = replace(recipe, program=Program.GENERAL, features=tuple(map(exactly_known, recipe.features)))
    robot = replace(robot, stiffness_std=1e-9 * robot.stiffness)
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))
    results = {"document": json.loads((folder / "out" / "diagnosis.json").read_text())}
    for name, model in (
        ("springs", load_compliance_model(layout.robot)),
        ("extended", load_compliance_model(folder / "out" / "model.yaml")),
    ):
        program = generate_program(recipe, T_base_door, layout, robot, model)
        executed = _execute.execute(program, robot, Kinematics(robot), layout.T_flange_tool, Reality(robot))
        results[name] = inspect(recipe, T_base_door, executed)
    return results


def most_of_the_wall(part):
    """What 95 % of the wall stay within [mm]: where a load changes sides the gap jumps, faster than targets follow."""
    return 1e3 * np.percentile(np.abs(np.concatenate([f.deviation for f in part.features])), 95.0)


def test_the_deviation_of_most_of_the_wall_shrinks_by_a_third(milled):
    before, after = (most_of_the_wall(milled[name]) for name in ("springs", "extended"))
    assert before > 0.1, "the backlash must show on the part"
    assert after < 0.67 * before


def test_every_feature_gains(milled):
    assert [feature.feature for feature in milled["springs"].features] == ["hinge_1", "hinge_2"]
    for one, two in zip(milled["springs"].features, milled["extended"].features, strict=True):
        assert np.sqrt(np.mean(two.deviation**2)) < 0.8 * np.sqrt(np.mean(one.deviation**2))
        assert two.max_deviation < one.max_deviation


def test_the_page_on_the_method_tells_this_gain(milled):
    docs = Path(__file__).resolve().parents[2] / "docs" / "diagnosis.md"
    text = " ".join(docs.read_text().split())
    told = re.search(r"leaves 95 % of the walls within ([0-9.]+) mm .*? and ([0-9.]+) mm with", text)
    before, after = map(float, told.groups())
    assert most_of_the_wall(milled["springs"]) == pytest.approx(before, rel=0.1)
    assert most_of_the_wall(milled["extended"]) == pytest.approx(after, rel=0.1)


def test_the_diagnosis_says_how_far_the_path_moves(milled):
    """A gap turns the whole arm by so much at most; half of it where a target is cut from either side."""
    shift = milled["document"]["path_shift"]
    assert shift["door"] == "thesis_1350_0deg"
    assert set(shift["largest"]) == {feature.feature for feature in milled["springs"].features}
    reach = 2.5  # m, of the arm
    for away in shift["largest"].values():
        assert 0.0 < away < 1.1e-4 * reach
    assert max(shift["largest"].values()) > 2e-5
