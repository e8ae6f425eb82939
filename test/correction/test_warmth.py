"""A growth is undone as far as its law is sure of it."""

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.loads import certain
from doormill_ros.correction.worth import worth_of
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.extended_model import load_model_of
from doormill_ros.robot_model.warmth.grown_model import grown
from doormill_ros.robot_model.warmth.growth import GrowthLaw, ThermalGrowth

ROBOT, TOOL = load_robot("irb6600_175_255"), load_layout().T_flange_tool
KINEMATICS = Kinematics(ROBOT)
Q = np.random.default_rng(2).uniform(-0.5, 0.5, (12, 6)) + 0.8 * np.eye(6)[4]
WAY = 2e-4
GROWTH = ThermalGrowth((GrowthLaw(1.0, WAY, 0.0, 1.0),), 1.0, 180.0)


@pytest.mark.parametrize("std", [0.0, 1e-4, 2e-4, 8e-4])
def test_what_is_undone_shrinks_with_its_doubt_to_what_leaves_the_least_mean_square(std):
    model = grown(load_model_of(ROBOT), KINEMATICS, GROWTH, WAY, std)
    loaded = LoadedRobot(KINEMATICS, model, TOOL, worth=worth_of(ROBOT, 4e-5, model))
    nominal = KINEMATICS.forward(Q) @ TOOL
    found = loaded.corrected(nominal, Q, certain(np.zeros((12, 6)), np.zeros((12, 6))))
    place = nominal[:, :3, 3]
    toward = -np.sum((found.T_base_tool[:, :3, 3] - place) * place, axis=1) / np.linalg.norm(place, axis=1)
    assert toward == pytest.approx(WAY / (1.0 + (std / WAY) ** 2), rel=0.01)
