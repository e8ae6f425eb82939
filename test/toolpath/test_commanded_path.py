"""The path that targets tell, beside what the simulated controller recorded when it ran them."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.messages.from_message import program_of
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.commanded_path import SAG, STEP, commanded_path
from doormill_ros.toolpath.pacing.pace import ZONES
from support.gauged_shift import commanded
from support.source_tree import ROOT

LAYOUT = load_layout()
KINEMATICS = Kinematics(load_robot(LAYOUT.robot))
DOORS = ("thesis_190_0deg", "thesis_1350_0deg", "standard_door")


def told(name):
    (message,) = [item.message for item in read_bag(ROOT / "bags" / name, ["/path/targets"])]
    return commanded_path(program_of(message), KINEMATICS, LAYOUT.T_flange_tool)


def beside(points, way):
    """Distance of points from the pieces between neighbouring points of a way, shapes (n, 3) and (m, 3)."""
    middle, piece = 0.5 * (way[1:] + way[:-1]), np.diff(way, axis=0)
    _, near = cKDTree(middle).query(points, k=3)
    start, along = way[near], piece[near]
    square = np.maximum(np.sum(along**2, axis=2), 1e-18)
    share = np.clip(np.sum((points[:, None] - start) * along, axis=2) / square, 0.0, 1.0)
    return np.linalg.norm(points[:, None] - start - share[..., None] * along, axis=2).min(axis=1)


@pytest.mark.parametrize("name", DOORS)
def test_it_is_where_the_controller_went_but_for_corners_that_this_flew_by(name):
    path, run = told(name), commanded(name).path
    off = beside(run.T_base_tool_commanded[run.cutting, :3, 3], path.tool[path.cutting, :3, 3])
    assert np.quantile(off, 0.9) < 2.0 * SAG
    assert off.max() < max(ZONES.values()) / 2.0
    assert path.time[-1] > 0.0
    assert np.all(np.diff(path.time) >= 0.0)


@pytest.mark.parametrize("name", DOORS)
def test_joints_and_loads_are_those_that_the_controller_had(name):
    path, run = told(name), commanded(name).path
    reached = KINEMATICS.forward(path.q) @ LAYOUT.T_flange_tool
    assert np.abs(reached[path.cutting] - path.tool[path.cutting]).max() < 1e-7
    for feature in dict.fromkeys(path.feature):
        own, theirs = ((np.array(one.feature) == feature) & one.cutting for one in (path, run))
        if not own.any():
            continue
        # Half a step away the joints are that far from each other, at an arm of a metre and more.
        distance, near = cKDTree(path.tool[own, :3, 3]).query(run.T_base_tool_commanded[theirs, :3, 3])
        assert np.abs(path.q[own][near] - run.q[theirs])[distance < STEP].max() < 2e-3
        assert np.median(np.linalg.norm(path.wrench[own][near] - run.wrench[theirs], axis=1)) < 1.0
    assert not path.wrench[~path.cutting].any()
    assert set(path.feature) >= set(np.unique(run.feature[run.cutting]))
