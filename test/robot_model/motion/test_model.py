"""A model of moving joints goes through its file unchanged, and predicts by the laws of its causes."""

import numpy as np
import pytest
import yaml

from doormill_ros.robot_model.errors import MotionModelError
from doormill_ros.robot_model.motion.causes.joint_backlash import JointBacklash
from doormill_ros.robot_model.motion.causes.joint_friction import MotionFriction
from doormill_ros.robot_model.motion.causes.joint_periodic_error import MotionPeriodicError
from doormill_ros.robot_model.motion.causes.registry import LIBRARY
from doormill_ros.robot_model.motion.model import (
    JointModel,
    MotionModel,
    load_motion_model,
    model_document,
)
from doormill_ros.robot_model.motion.view import JointMotion

STIFFNESS = 4.0e6


def motion(link=lambda t, m, tau: m - tau / STIFFNESS):
    time = np.arange(2000) / 250.0
    motor = 0.4 * np.sin(1.3 * time)
    torque = 800.0 * np.cos(0.9 * time) + 300.0
    return JointMotion(
        2, time, motor, link(time, motor, torque), torque, 250.0, STIFFNESS, motor_inertia=0.01
    )


def test_a_perfect_gear_leaves_nothing():
    assert np.abs(JointModel(2, STIFFNESS).residual(motion())).max() < 1e-12


def test_a_late_encoder_shows_where_the_joint_was():
    late = motion(
        lambda t, m, tau: 0.4 * np.sin(1.3 * (t - 0.005)) - np.interp(t - 0.005, t, tau) / STIFFNESS
    )
    assert np.abs(JointModel(2, STIFFNESS).residual(late)).max() > 2e-3
    left = JointModel(2, STIFFNESS, 0.005).residual(late)[10:]
    assert np.ptp(left) < 1e-6


def test_bristles_remember_where_they_turned():
    seen = motion().seen()
    state = seen.slip(0.01, 0.0)
    turn = int(np.argmax(seen.motor[:500]))
    assert state[turn] == 1.0
    back = turn + int(np.argmax(seen.motor[turn:1000] < seen.motor[turn] - 0.01))
    assert abs(state[back]) < 0.1  # halfway: bent back by half of 2 widths
    assert state.min() == -1.0


def test_a_fine_scale_is_given_its_phase_and_no_other_height():
    def link(t, m, tau):
        return m - tau / STIFFNESS + 5e-5 * np.cos(300.0 * m + 1.0)

    wave = MotionPeriodicError("joint 2", 300.0, free=True)
    model = JointModel(2, STIFFNESS, 0.0, (wave,), (np.array([5e-5]),))
    assert model.residual(motion(link)).std() < 1e-7
    assert model.residual(motion(link), own=False).std() > 3e-5
    lower = JointModel(2, STIFFNESS, 0.0, (wave,), (np.array([3e-5]),))
    assert lower.residual(motion(link)).std() == pytest.approx(2e-5 / np.sqrt(2.0), rel=0.05)


def test_model_goes_through_its_file(tmp_path):
    causes = (
        MotionFriction("joint 2", 3e-4),
        JointBacklash("joint 2", "held", 5e-5),
        MotionPeriodicError("joint 2", 8.0, "motor", False, True),
    )
    x = (np.array([1e-5]), np.array([1e-4]), np.array([1e-5, -2e-5]))
    before = MotionModel("some_robot", (JointModel(2, STIFFNESS, 0.003, causes, x),))
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(model_document(before, "a test")))
    after = load_motion_model(tmp_path)
    assert np.array_equal(after.of(2).residual(motion()), before.of(2).residual(motion()))


@pytest.mark.parametrize(
    "text",
    [
        "schema: other",
        "[]",
        "schema: doormill/extended-motion-model/1",
        "{schema: doormill/extended-motion-model/1, robot: r, joints: [{joint: 1, stiffness: 1.0, "
        "link_encoder_late: 0.0, causes: [{cause: witchcraft, where: joint 1, coefficients: [1.0]}]}]}",
    ],
)
def test_broken_model_is_refused(tmp_path, text):
    (tmp_path / "model.yaml").write_text(text)
    with pytest.raises(MotionModelError):
        load_motion_model(tmp_path)


@pytest.mark.parametrize("kind", LIBRARY)
def test_every_cause_tells_what_it_leaves_and_what_it_is_sized_by(kind):
    seen = (motion().seen(),)
    offered = kind.candidates("joint 2", seen)
    assert offered
    for cause in offered:
        columns = cause.columns(seen[0])
        assert len(columns) == len(seen[0])
        assert np.all(np.isfinite(columns))
        assert cause.pattern()
        values = cause.values(np.full(columns.shape[1], 1e-5), STIFFNESS)
        assert all(np.isfinite(value) and unit for value, unit in values.values())
        again = kind.build("joint 2", cause.settings)
        assert np.array_equal(again.columns(seen[0]), columns)
