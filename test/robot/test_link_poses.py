"""Frames of the URDF's links, held to the Denavit-Hartenberg kinematics, which come from another file."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot.urdf import joint_names, link_poses

ROBOTS = ["irb6600_175_255", "irb6700_235_265"]


@pytest.mark.parametrize("name", ROBOTS)
def test_the_last_link_is_the_flange_of_the_kinematics(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(7)
    for q in rng.uniform(robot.lower, robot.upper, size=(20, 6)):
        T_base_link = np.eye(4)
        for pose in link_poses(robot.urdf, q):
            T_base_link = T_base_link @ pose.T_parent_child
        assert np.abs(T_base_link - Kinematics(robot).forward(q)).max() < 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_links_hang_on_each_other_from_base_to_flange(name: str) -> None:
    poses = link_poses(load_robot(name).urdf, np.zeros(6))
    assert [p.parent for p in poses] == ["base_link", *(p.child for p in poses[:-1])]
    assert [p.child for p in poses] == [f"link_{n}" for n in range(1, 7)] + ["flange"]
    assert joint_names(load_robot(name).urdf) == [f"joint_{n}" for n in range(1, 7)]
