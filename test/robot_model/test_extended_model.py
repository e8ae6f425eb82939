"""The extended model as a file: it comes back as written, predicts as the truth does, and refuses rubbish."""

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import (
    ExtendedComplianceModel,
    SizedCause,
    load_compliance_model,
    load_model_of,
)
from doormill_ros.simulation.truth.robot import TruthRobot

ROBOT = "irb6600_175_255"
LOAD_POINT = np.array([0.02, 0.0, 0.18])
CASES = [
    ("joint_backlash", "joint 1", {"gap": 1e-4, "crossing": 8.0}),
    ("joint_stiffness", "joint 3", {"stiffness": 1.1e6}),
    ("joint_hardening", "joint 2", {"stiffness": 1.5e6, "hardening": 2e-3}),
    ("joint_friction", "joint 3", {"torque": 20.0}),
    ("joint_cross_compliance", "joint 4", {"compliance": 3e-7}),
    ("link_bending", "link 2", {"EI": 4e6}),
    ("base_compliance", "base", {"stiffness": 1e7}),
    ("tool_compliance", "flange", {"stiffness": 2e5}),
    ("joint_offset", "joint 3", {"angle": 0.05}),
]


def flat(parameters):
    return np.concatenate([np.atleast_1d(np.asarray(v, dtype=float)) for v in parameters.values()])


def loads(n=40, seed=1):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.0, 1.0, (n, 6))
    wrench = rng.normal(size=(n, 6)) * np.array([60.0] * 3 + [10.0] * 3)
    return q, wrench, rng.choice([-1.0, 1.0], (n, 6))


@pytest.mark.parametrize(("name", "where", "parameters"), CASES, ids=[c[0] for c in CASES])
def test_deflection_is_that_of_the_simulated_truth(name, where, parameters):
    robot = load_robot(ROBOT)
    model = ExtendedComplianceModel(
        ROBOT, robot.dh, robot.stiffness, [SizedCause(build_cause(name, where), flat(parameters))]
    )
    truth = TruthRobot(robot.dh, [{"cause": name, "where": where, "parameters": parameters}], robot.stiffness)
    q, wrench, direction = loads()
    still, loaded = truth.forward(q), truth.deflected(q, wrench, LOAD_POINT, direction)
    point = np.append(LOAD_POINT, 1.0)
    shift = ((loaded - still) @ point)[:, :3]
    turn = Rotation.from_matrix(loaded[:, :3, :3] @ still[:, :3, :3].transpose(0, 2, 1)).as_rotvec()
    twist = model.deflection(q, wrench, LOAD_POINT, direction)
    plain = ExtendedComplianceModel(ROBOT, robot.dh, robot.stiffness, ()).deflection(q, wrench, LOAD_POINT)
    assert np.abs(twist - plain).max() > 5e-6
    np.testing.assert_allclose(twist[:, :3], shift, atol=0.3e-6)
    np.testing.assert_allclose(twist[:, 3:], turn, atol=0.3e-6)


def test_without_causes_it_is_the_joint_spring_model():
    robot = load_robot(ROBOT)
    q, wrench, direction = loads()
    own = load_compliance_model(ROBOT).deflection(q, wrench, LOAD_POINT, direction)
    np.testing.assert_allclose(own, JointSpringModel(robot).deflection(q, wrench, LOAD_POINT), atol=1e-15)


def test_a_model_comes_back_as_written(tmp_path):
    causes = [SizedCause(build_cause(n, w), flat(p)) for n, w, p in CASES]
    causes.append(SizedCause(build_cause("base_compliance", "base", "two axes"), np.array([2e7, 3e7])))
    causes.append(SizedCause(build_cause("tracker_frame_rotation", "tracker"), np.array([0.01, 0.0, 0.0])))
    robot = load_robot(ROBOT)
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(model_document(ROBOT, robot.stiffness, causes, "test")))
    q, wrench, direction = loads()
    expected = ExtendedComplianceModel(ROBOT, robot.dh, robot.stiffness, causes).deflection(
        q, wrench, LOAD_POINT, direction
    )
    for source in (path, str(path), tmp_path):
        model = load_compliance_model(source)
        np.testing.assert_array_equal(model.deflection(q, wrench, LOAD_POINT, direction), expected)


def test_the_measuring_chain_does_not_bend_the_robot():
    robot = load_robot(ROBOT)
    q, wrench, direction = loads()
    plain = ExtendedComplianceModel(ROBOT, robot.dh, robot.stiffness, ())
    for name, where, values in (
        ("wrench_gain", "sensor", [1.3]),
        ("tracker_scale", "tracker", [0.7]),
        ("wrench_frame_rotation", "sensor", [0.4]),
        ("thermal_drift", "cell", [1e-6, 0, 0]),
        ("reflector_position", "ee", [0.1, 0, 0]),
        ("tracker_frame_rotation", "tracker", [0.1, 0, 0]),
    ):
        cause = build_cause(name, where)
        assert not cause.of_robot
        model = ExtendedComplianceModel(
            ROBOT, robot.dh, robot.stiffness, [SizedCause(cause, np.array(values))]
        )
        np.testing.assert_array_equal(
            model.deflection(q, wrench, LOAD_POINT, direction), plain.deflection(q, wrench, LOAD_POINT)
        )


def test_an_unknown_last_motion_gets_half_of_the_gap():
    robot = load_robot(ROBOT)
    cause = SizedCause(build_cause("joint_backlash", "joint 1"), np.array([1e-4, 0.0]))
    model = ExtendedComplianceModel(ROBOT, robot.dh, robot.stiffness, [cause])
    q, wrench = np.zeros((1, 6)), np.array([[0.0, 100.0, 0.0, 0.0, 0.0, 0.0]])
    along, against, unknown = (
        model.deflection(q, wrench, LOAD_POINT, np.full((1, 6), a)) for a in (1.0, -1.0, 0.0)
    )
    np.testing.assert_allclose(unknown, (along + against) / 2.0)
    assert (along - against)[0, 5] == pytest.approx(1e-4)
    np.testing.assert_array_equal(model.deflection(q, wrench, LOAD_POINT), unknown)


def test_a_model_comes_back_with_what_was_measured_of_it(tmp_path):
    gap = SizedCause(build_cause("joint_backlash", "joint 2"), np.array([1e-4, 5.0]), np.array([2e-6, 0.0]))
    spring = SizedCause(build_cause("joint_stiffness", "joint 3"), np.array([1.1e6]), np.array([3e4]))
    unsure = SizedCause(build_cause("joint_stiffness", "joint 4"), np.array([3e5]))
    robot = load_robot(ROBOT)
    force = MeasuredForce(("hinge_oblong",), 0.02, 0.03)
    path = tmp_path / "model.yaml"
    document = model_document(ROBOT, robot.stiffness, [gap, spring, unsure], "test", force=force)
    path.write_text(yaml.safe_dump(document))
    known = load_compliance_model(path).knowledge()
    assert known.force == force
    np.testing.assert_array_equal(known.gap_std, [0.0, 2e-6, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(known.stiffness_std, [np.nan, np.nan, 3e4, np.nan, np.nan, np.nan])
    np.testing.assert_array_equal(known.stiffness[2:4], [1.1e6, 3e5])
    for broken in (
        {"measured_force": {**force.document(), "factor_std": -0.1}},
        {"measured_force": {**force.document(), "kinds": "hinge_oblong"}},
        {"measured_force": {"kinds": []}},
        {"causes": [{**document["causes"][1], "std": {"stiffness": -1.0}}]},
    ):
        path.write_text(yaml.safe_dump(document | broken))
        with pytest.raises(ExtendedModelError, match="cannot be used"):
            load_compliance_model(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"schema": "doormill/extended-model/9"}, "schema"),
        ({"robot": "c3po"}, "c3po"),
        ({"joint_stiffness": [1, 2, 3]}, "joint_stiffness"),
        ({"joint_stiffness": [1, 1, 1, 1, 1, -1]}, "joint_stiffness"),
        ({"causes": [{"cause": "gremlins", "where": "joint 1", "parameters": {}}]}, "gremlins"),
        ({"causes": [{"cause": "link_bending", "where": "link 2", "parameters": {}}]}, "EI"),
        ({"causes": [{"cause": "link_bending", "where": "link 2", "parameters": {"EI": "soft"}}]}, "soft"),
        ({"causes": 3}, "causes: it is 3"),
    ],
)
def test_rubbish_is_refused(tmp_path, change, message):
    document = model_document(ROBOT, load_robot(ROBOT).stiffness, [], "test")
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump({**document, **change}))
    with pytest.raises(ExtendedModelError, match=message):
        load_compliance_model(path)


def test_what_is_neither_file_nor_robot_is_refused(tmp_path):
    with pytest.raises(ExtendedModelError, match="neither"):
        load_compliance_model(tmp_path / "nothing.yaml")
    (tmp_path / "x.yaml").write_text("a: [1,\n")
    with pytest.raises(ExtendedModelError, match="cannot be read"):
        load_compliance_model(tmp_path / "x.yaml")


def test_a_model_of_another_robot_is_refused(tmp_path):
    other = load_robot("irb6700_235_265")
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(model_document(other.name, other.stiffness, [], "test")))
    with pytest.raises(ExtendedModelError, match=f"{other.name}.*mills with {ROBOT}.*cell.yaml"):
        load_model_of(load_robot(ROBOT), path)
    assert load_model_of(other, path).robot == other.name
    np.testing.assert_array_equal(load_model_of(other).joint_stiffness, other.stiffness)


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("joint_backlash", {"gap": 1e-4, "crossing": 0.0}),
        ("joint_friction", {"torque": 20.0}),
        ("joint_hardening", {"stiffness": 1.5e6, "hardening": 2e-3}),
    ],
)
@pytest.mark.parametrize("force", [0.0, 50.0], ids=["no load", "a load that turns joint 1 nowhere"])
def test_a_joint_without_load_gives_way_by_a_number(name, parameters, force):
    robot = load_robot(ROBOT)
    model = ExtendedComplianceModel(
        ROBOT, robot.dh, robot.stiffness, [SizedCause(build_cause(name, "joint 1"), flat(parameters))]
    )
    q = np.tile([0.2, -0.3, 0.4, 0.1, 0.5, 0.3], (3, 1))
    wrench = np.tile([0.0, 0.0, force, 0.0, 0.0, 0.0], (3, 1))
    twist = model.deflection(q, wrench, np.zeros(3), np.ones((3, 6)))
    assert np.all(np.isfinite(twist))
    plain = ExtendedComplianceModel(ROBOT, robot.dh, robot.stiffness, ()).deflection(q, wrench, np.zeros(3))
    assert np.abs(twist - plain).max() < 3e-4  # half of a gap 3 m away
