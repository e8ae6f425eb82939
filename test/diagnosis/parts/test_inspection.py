"""Milled doors as loading tests: the wall alone must give the hidden cause away."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.cell.layout import DoorOffset, load_layout
from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.parts.inspection import match_contour, part_problem
from doormill_ros.frames import apply
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.milled_part import inspect
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.toolpath.generate import generate_program
from support import execute as _execute

ACCURACY = 1e-5  #: of a coordinate measuring machine, and of contours sampled every quarter millimetre


class Reality:
    def __init__(self, robot, effects):
        self.truth = TruthRobot(robot.dh, effects, robot.stiffness)

    def deflection(self, q, wrench, load_point, direction=None):
        still, loaded = self.truth.forward(q), self.truth.deflected(q, wrench, load_point, direction)
        shift = ((loaded - still) @ np.append(load_point, 1.0))[:, :3]
        turn = Rotation.from_matrix(loaded[:, :3, :3] @ still[:, :3, :3].transpose(0, 2, 1)).as_rotvec()
        return np.concatenate([shift, turn], axis=1)


def mill_and_measure(effects, seed):
    layout = load_layout()
    robot = load_robot(layout.robot)
    springs, rng, contours = JointSpringModel(robot), np.random.default_rng(seed), []
    for name in ("thesis_190_0deg", "thesis_1350_0deg"):
        recipe = load_recipe(name)
        T_base_door = layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(0.0, 0.0, 0.0))
        program = generate_program(recipe, T_base_door, layout, robot, springs)
        path = _execute.execute(
            program, robot, Kinematics(robot), layout.T_flange_tool, Reality(robot, effects)
        )
        part = inspect(recipe, T_base_door, path)
        for feature in recipe.features:
            result = part.feature(feature.id)
            rows = np.arange(0, len(result.points) - 1, 12)
            way = np.roll(result.points[:-1], -1, axis=0) - np.roll(result.points[:-1], 1, axis=0)
            first, second = result.points[:-1], result.points[1:]
            area = np.sum(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
            out = np.column_stack([way[:, 1], -way[:, 0]]) * np.sign(area)
            out /= np.linalg.norm(out, axis=1, keepdims=True)
            T = T_base_door @ recipe.T_door_feature(feature)
            depth = result.depths[-1]
            flat = np.column_stack([result.points[rows], np.full(len(rows), depth)])
            normal = np.column_stack([out[rows], np.zeros(len(rows))]) @ T[:3, :3].T
            contours.append(
                match_contour(
                    apply(T, flat), normal, result.by_depth[-1][rows] + rng.normal(0.0, ACCURACY, len(rows)),
                    tool_radius=feature.tool.radius, tool=path.T_base_tool_commanded[:, :3, 3], q=path.q,
                    wrench=path.wrench, time=path.time,
                    cutting=path.cutting & np.char.equal(path.feature, feature.id),
                )
            )  # fmt: skip
    return diagnose_problem(part_problem(contours, robot, layout.T_flange_tool, 1.5 * ACCURACY))


@pytest.fixture(scope="module")
def worn():
    gap = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 1e-4, "crossing": 0.0}}
    return mill_and_measure([gap], seed=1)


def test_a_part_without_hidden_effect_blames_nothing():
    assert mill_and_measure([], seed=2).findings == ()


def test_the_backlash_shows_on_the_wall(worn):
    assert worn.verdict in ("explained", "partly_explained")
    keys = [f.cause.key for f in worn.findings]
    assert keys == [("joint_backlash", "joint 1")]
    gap = worn.findings[0].values[0]
    assert gap == pytest.approx(1e-4, rel=0.15)
    assert worn.ratio < 0.6
