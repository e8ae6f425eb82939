"""The way of the tool, finely: every pass from its begin to its end, and nothing between passes."""

from types import SimpleNamespace

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.parts.doors.way import FINER, Moving, way_through
from doormill_ros.robot.description import load_robot

PASS = np.array([0.0, 2.0, 4.0, 6.0, 8.0, 10.0]) * 1e-3


def test_every_pass_is_followed_to_its_end():
    layout = load_layout()
    robot = load_robot(layout.robot)
    n = 2 * len(PASS) + 1
    tool = np.tile(np.eye(4), (n, 1, 1))
    tool[:, 1, 3] = np.concatenate([PASS, [5e-2], PASS])
    tool[len(PASS) + 1 :, 2, 3] = 3e-3
    cutting = np.arange(n) != len(PASS)
    q = np.tile([0.1, 0.2, 0.1, 0.3, 0.5, 0.2], (n, 1)) + 1e-3 * np.arange(n)[:, None]
    cut = SimpleNamespace(tool=tool, q=q, wrench=np.ones((n, 6)), time=0.1 * np.arange(n))
    way = way_through(cut, Moving.along(cut), cutting, np.eye(4), robot, layout.T_flange_tool)
    for depth in (0.0, 3e-3):
        y = way.flat[way.flat[:, 2] == depth, 1]
        assert np.allclose(y, np.linspace(0.0, PASS[-1], FINER * (len(PASS) - 1) + 1))
    assert len(way.flat) == 2 * (FINER * (len(PASS) - 1) + 1)
    assert np.all(way.direction[1:] == 1.0)
    assert np.allclose(way.feed[way.flat[:, 1] > PASS[1] - 1e-9], 0.02)
