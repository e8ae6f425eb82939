"""Terms of laws: against springs of the stiffness that a law says, through model.yaml, without a driver."""

import numpy as np
import pytest
import yaml

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.law.carriers import CARRIERS
from doormill_ros.robot_model.elastic.law.cracks import CRACKS
from doormill_ros.robot_model.elastic.law.dictionary import dictionary
from doormill_ros.robot_model.elastic.law.edges import EDGES, ROUGH
from doormill_ros.robot_model.elastic.law.term import LawTerm
from doormill_ros.robot_model.elastic.load_case import build_load_case
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import (
    ExtendedComplianceModel,
    SizedCause,
    load_compliance_model,
    unknown_on_path,
)
from doormill_ros.robot_model.law.shapes import columns
from doormill_ros.robot_model.law.term import SeenRange

ROBOT = load_robot("irb6600_175_255")
POINT = np.array([0.1, -0.05, 0.3])
Q = np.array([0.4, 0.2, -0.5, 0.3, 0.7, -0.2])
WRENCH = np.array([300.0, -150.0, 200.0, 10.0, -20.0, 5.0])


def softened(joint, share):
    """What springs say of which one gives way more by a share."""
    stiffness = ROBOT.stiffness.copy()
    stiffness[joint] /= 1.0 + share
    return ExtendedComplianceModel(ROBOT.name, ROBOT.dh, stiffness, ()).deflection(Q, WRENCH, POINT)


def with_law(term, weights):
    return ExtendedComplianceModel(
        ROBOT.name, ROBOT.dh, ROBOT.stiffness, (), [SizedCause(term, np.array(weights))]
    )


def spring(driver, shape, numbers, usual, low=-3.0, high=3.0, where="joint 2"):
    return LawTerm(where, "spring", driver, shape, numbers, SeenRange(low, high, usual))


def test_a_spring_with_waves_is_a_softer_spring_at_that_angle():
    law = with_law(spring("own angle", "waves", (7.0,), (0.0, 0.0)), [0.3, -0.1])
    share = 0.3 * np.sin(7.0 * Q[1]) - 0.1 * np.cos(7.0 * Q[1])
    np.testing.assert_allclose(law.deflection(Q, WRENCH, POINT), softened(1, share), rtol=1e-9)


def test_a_spring_may_hang_on_the_angle_of_another_joint():
    law = with_law(spring("angle of joint 5", "slope", (), (0.0,)), [0.25])
    np.testing.assert_allclose(law.deflection(Q, WRENCH, POINT), softened(1, 0.25 * Q[4]), rtol=1e-9)


def test_beyond_what_was_seen_the_nearest_value_stands():
    law = with_law(spring("angle of joint 5", "square", (1.0,), (0.0,), high=0.5), [0.25])
    np.testing.assert_allclose(law.deflection(Q, WRENCH, POINT), softened(1, 0.25 * 0.5**2), rtol=1e-9)


@pytest.mark.parametrize(("low", "ends"), [(0.1, 0.7), (-0.5, Q[4])])
def test_a_straight_line_goes_on_by_half_of_what_was_seen(low, ends):
    law = with_law(spring("angle of joint 5", "slope", (), (0.0,), low=low, high=0.5), [0.25])
    np.testing.assert_allclose(law.deflection(Q, WRENCH, POINT), softened(1, 0.25 * ends), rtol=1e-9)


@pytest.mark.parametrize(("low", "ends"), [(-0.9, Q[1]), (-0.4, -0.1)])
def test_waves_go_on_where_half_of_one_was_seen(low, ends):
    law = with_law(spring("own angle", "waves", (5.0,), (0.0, 0.0), low=low, high=-0.2), [0.3, -0.1])
    share = 0.3 * np.sin(5.0 * ends) - 0.1 * np.cos(5.0 * ends)
    np.testing.assert_allclose(law.deflection(Q, WRENCH, POINT), softened(1, share), rtol=1e-9)


def test_a_law_that_is_a_part_of_a_curve_ends_where_it_was_seen_through_its_file_too():
    term = spring("own angle", "slope", (), (0.0,), low=-0.6, high=0.1).ended()
    again, weights = LawTerm.read(yaml.safe_load(yaml.safe_dump(term.document(np.array([0.3])))))
    np.testing.assert_allclose(
        with_law(again, weights).deflection(Q, WRENCH, POINT), softened(1, 0.3 * 0.1), rtol=1e-9
    )


def test_a_driver_that_no_path_knows_acts_with_its_mean_and_is_told():
    model = with_law(spring("time under load", "logarithm", (15.0,), (1.4,), 15.0, 120.0), [0.1])
    np.testing.assert_allclose(model.deflection(Q, WRENCH, POINT), softened(1, 0.14), rtol=1e-9)
    (sentence,) = unknown_on_path(model)
    assert "joint 2" in sentence
    assert "time under load" in sentence
    assert unknown_on_path(with_law(spring("own angle", "waves", (7.0,), (0.0, 0.0)), [0.3, 0.0])) == ()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_foot_tips_over_the_edge_that_the_load_pulls_towards_and_over_no_other(side):
    edge = next(one for one in ROUGH if (one.where, one.way, one.width) == ("base", 30, 0.4))
    holds, most, turn = 40.0, 500.0, 3e-4
    wrench = side * np.array([400.0, 300.0, -100.0, 0.0, 0.0, 0.0])
    term = LawTerm("base", edge.acts_on, edge.driver, "opening", (holds, most), SeenRange(0.0, 100.0, (0.2,)))
    frame = Kinematics(ROBOT.dh).link_frames(Q)[6]
    tip = frame[:3, :3] @ POINT + frame[:3, 3]
    out = np.array([np.cos(np.radians(30.0)), np.sin(np.radians(30.0)), 0.0])
    axis = np.cross([0.0, 0.0, 1.0], out)
    # The tool's load is in the axes of the base, as everywhere here.
    moment = axis @ np.cross(tip - 0.4 * out, wrench[:3])
    assert (moment > holds) == (side > 0.0)
    # What opens goes on opening beyond what a test has seen.
    angle = turn * max(moment - holds, 0.0) / most
    moved = with_law(term, [turn]).deflection(Q, wrench, POINT) - with_law(term, [0.0]).deflection(
        Q, wrench, POINT
    )
    np.testing.assert_allclose(
        np.ravel(moved)[:3], np.cross(angle * axis, tip - 0.4 * out), rtol=1e-6, atol=1e-12
    )


@pytest.mark.parametrize("way", [30, 75, 200])
def test_a_crack_opens_its_link_half_way_when_the_load_bends_it_one_way_and_not_the_other(way):
    crack, most, turn = CRACKS[f"crack at {way} deg"], 500.0, 3e-4
    term = LawTerm("link 2", crack.acts_on, crack.driver, "opening", (0.0, most), SeenRange(0.0, 9.0, (0.2,)))
    frames = Kinematics(ROBOT.dh).link_frames(Q)
    near, far, tip = frames[1][:3, 3], frames[2][:3, 3], frames[6][:3, :3] @ POINT + frames[6][:3, 3]
    middle = 0.5 * (near + far)
    pull = np.array([400.0, 300.0, -100.0, 0.0, 0.0, 0.0])
    moved = []
    for wrench in (pull, -pull):
        with_it, without = (with_law(term, [size]).deflection(Q, wrench, POINT) for size in (turn, 0.0))
        moved.append((wrench[:3], np.ravel(with_it - without)))
    (force, open_), (_, shut) = sorted(moved, key=lambda one: -np.linalg.norm(one[1]))
    np.testing.assert_array_equal(shut, 0.0)
    angle = np.linalg.norm(open_[3:])
    axis = open_[3:] / angle
    assert abs(axis @ (far - near)) < 1e-6
    np.testing.assert_allclose(open_[:3], np.cross(open_[3:], tip - middle), rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(angle, turn * (axis @ np.cross(tip - middle, force)) / most, rtol=1e-6)
    assert {one.way for one in crack.beside()} == {way - 5, way + 5}


def test_what_twists_along_the_axis_of_its_joint_is_told_of_the_joint():
    rng = np.random.default_rng(3)
    case = build_load_case(
        Kinematics(ROBOT.dh),
        Q + rng.uniform(-0.5, 0.5, (9, 6)),
        rng.normal(0.0, [300.0] * 3 + [30.0] * 3, (9, 6)),
        POINT,
        joint_stiffness=ROBOT.stiffness,
    )
    for k in (4, 6):
        one, other = (
            np.ravel(CARRIERS[name].motion(case, f"{part} {k}")[0])
            for name, part in (("torsion", "link"), ("spring", "joint"))
        )
        np.testing.assert_allclose(one / np.linalg.norm(one), other / np.linalg.norm(other), atol=1e-12)
    twisting = {term.where for term in dictionary(case, []) if term.acts_on == "torsion"}
    assert twisting == {"link 1", "link 2", "link 3"}


def test_an_edge_has_others_beside_it_that_may_do_better():
    for edge in ROUGH:
        steps = {
            ((one.way - edge.way + 180) % 360 - 180, round(one.width - edge.width, 6))
            for one in edge.beside()
        }
        widths = {(0, -0.1), (0, 0.1)} if edge.where == "base" else set()
        assert steps == {(-5, 0.0), (5, 0.0)} | widths
        assert all(EDGES[one.acts_on] == one for one in edge.beside())


def test_laws_pass_through_the_file(tmp_path):
    terms = [
        SizedCause(spring("own angle", "waves", (7.0,), (0.1, 0.2)), np.array([0.3, -0.1])),
        SizedCause(
            LawTerm(
                "joint 3", "joint angle", "torque of joint 2", "slope", (), SeenRange(-900.0, 900.0, (0.0,))
            ),
            np.array([2e-8]),
        ),
    ]
    document = model_document(ROBOT.name, ROBOT.stiffness, [], "a test", laws=terms)
    (tmp_path / "model.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    before = ExtendedComplianceModel(ROBOT.name, ROBOT.dh, ROBOT.stiffness, (), terms)
    after = load_compliance_model(tmp_path)
    np.testing.assert_allclose(
        after.deflection(Q, WRENCH, POINT), before.deflection(Q, WRENCH, POINT), rtol=1e-12
    )
    assert "7 waves a turn" in document["laws"][0]["law"]


@pytest.mark.parametrize(
    "change",
    [
        {"shape": "spiral"},
        {"acts_on": "mood"},
        {"driver": "moon"},
        {"weights": {"value": [0.3], "unit": "1"}},
    ],
)
def test_a_law_of_no_use_is_refused(tmp_path, change):
    law = SizedCause(spring("own angle", "waves", (7.0,), (0.1, 0.2)), np.array([0.3, -0.1]))
    document = model_document(ROBOT.name, ROBOT.stiffness, [], "a test", laws=[law])
    document["laws"][0] |= change
    (tmp_path / "model.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    with pytest.raises(ExtendedModelError, match="write it anew with diagnose"):
        load_compliance_model(tmp_path)


def test_a_sensor_bias_is_the_springs_under_that_force():
    """Its three components are what the springs do under 1 N along each sensor axis at the load point."""
    kinematics, angle = Kinematics(ROBOT.dh), 0.7
    case = build_load_case(
        kinematics, Q[None], WRENCH[None], POINT, wrench_rotation=angle, joint_stiffness=ROBOT.stiffness
    )
    term = LawTerm("sensor", "force bias", "constant", "level", (), SeenRange(1.0, 1.0, (1.0,)))
    for axis in range(3):
        unit = np.zeros((1, 6))
        unit[0, axis] = 1.0
        loaded = build_load_case(
            kinematics, Q[None], unit, POINT, wrench_rotation=angle, joint_stiffness=ROBOT.stiffness
        )
        theta = term.from_values(np.eye(3)[axis], case)
        np.testing.assert_allclose(term.twist(case, theta), loaded.springs(), rtol=1e-9)


def test_a_curve_passes_through_its_weights():
    knots = (-1.0, -0.2, 0.3, 0.9, 1.4)
    np.testing.assert_allclose(columns("curve", np.array(knots), knots), np.eye(5), atol=1e-12)
