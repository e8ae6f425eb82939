"""A model with a process force of its own: the path generator gets the deflection under the true wrench."""

import numpy as np
import pytest
import yaml

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.extended_model import load_compliance_model

ROBOT = load_robot("irb6600_175_255")
Q = np.array([[0.1, -0.2, 0.3, 0.4, 0.9, -0.3], [0.3, 0.1, -0.1, -0.2, 1.1, 0.6]])
WRENCH = np.array([[20.0, -200.0, 30.0, 1.0, 2.0, -3.0], [0.0, 90.0, -40.0, 0.0, 0.0, 0.0]])
TIP = np.array([0.0, 0.0, 0.25])


def model(folder, *causes):
    document = {
        "schema": "doormill/extended-model/1",
        "robot": ROBOT.name,
        "source": "test",
        "joint_stiffness": [float(k) for k in ROBOT.stiffness],
        "causes": [{"cause": c, "where": "tool", "parameters": {n: v}} for c, n, v in causes],
    }
    (folder / "model.yaml").write_text(yaml.safe_dump(document))
    return load_compliance_model(folder / "model.yaml")


def test_a_larger_force_deflects_in_proportion(tmp_path):
    plain = model(tmp_path).deflection(Q, WRENCH, TIP)
    larger = model(tmp_path, ("process_force", "factor", 1.3)).deflection(Q, WRENCH, TIP)
    assert larger == pytest.approx(1.3 * plain, rel=1e-12)


def test_a_turned_force_is_turned_about_the_spindle(tmp_path):
    angle = 0.4
    turned = model(tmp_path, ("process_force_direction", "angle", angle)).deflection(Q, WRENCH, TIP)
    x, y, z = np.moveaxis(Kinematics(ROBOT).forward(Q)[:, :3, :3], 2, 0)
    # Written out in the axes of the flange: what lay along x lies along x turned by the angle.
    new_x, new_y = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x

    def rewritten(vector):
        sizes = [np.sum(vector * axis, axis=1, keepdims=True) for axis in (x, y, z)]
        return sizes[0] * new_x + sizes[1] * new_y + sizes[2] * z

    other = np.hstack([rewritten(WRENCH[:, :3]), rewritten(WRENCH[:, 3:])])
    assert turned == pytest.approx(model(tmp_path).deflection(Q, other, TIP), rel=1e-9)
    assert np.abs(turned - model(tmp_path).deflection(Q, WRENCH, TIP)).max() > 1e-5


def test_a_bending_mill_gives_way_across_itself_only(tmp_path):
    stiffness = 2e6
    plain = model(tmp_path).deflection(Q, WRENCH, TIP)
    bent = model(tmp_path, ("tool_bending", "stiffness", stiffness)).deflection(Q, WRENCH, TIP) - plain
    axis = Kinematics(ROBOT).forward(Q)[:, :3, 2]
    along = np.sum(WRENCH[:, :3] * axis, axis=1, keepdims=True) * axis
    assert bent[:, :3] == pytest.approx((WRENCH[:, :3] - along) / stiffness, abs=1e-15)
    assert np.all(bent[:, 3:] == 0.0)
