import logging
import shutil

import numpy as np
import pytest
import yaml

from doormill_ros.resources import resource
from doormill_ros.robot.description import _load, load_robot
from doormill_ros.robot.errors import GeometryError, RobotDescriptionError
from doormill_ros.robot.kinematics import Kinematics
from support.inverse_kinematics import inverse
from support.pinocchio_model import PinocchioKinematics


@pytest.fixture
def folder(tmp_path):
    target = tmp_path / "a_robot"
    shutil.copytree(resource("config/robots/irb6600_175_255"), target)
    return target


def edit(folder, change):
    path = folder / "robot.yaml"
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    change(document)
    path.write_text(yaml.safe_dump(document), encoding="utf-8")


def test_study_range_of_the_thesis_is_allowed(irb6600):
    # Sections 3.4 and 3.5: joint 2 from -65 to 85 deg, joint 3 from -180 to 70 deg.
    assert np.degrees(irb6600.lower[1:3]) == pytest.approx([-65, -180])
    assert np.degrees(irb6600.upper[1:3]) == pytest.approx([85, 70])


def test_lengths_reach_as_far_as_the_type_name_says(robot):
    stretched = robot.dh[0, 2] + robot.dh[1, 2] + np.hypot(robot.dh[2, 2], robot.dh[3, 1])
    assert stretched == pytest.approx(robot.reach, abs=0.005)


def test_stiffness_of_the_irb6700_is_marked_as_nobody_measured_it():
    assert "stiffness" in load_robot("irb6700_235_265").unmeasured()
    assert "stiffness" not in load_robot("irb6600_175_255").unmeasured()


def test_arrays_cannot_be_changed(robot):
    for array in (robot.dh, robot.lower, robot.upper, robot.max_velocity, robot.stiffness):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_unmeasured_figures_are_told_by_who_moves_a_robot_and_not_by_who_reads_the_file(folder, caplog):
    with caplog.at_level(logging.DEBUG):
        first, second = load_robot(folder), load_robot(folder / "robot.yaml")
    assert first is second
    assert [record.getMessage() for record in caplog.records] == []
    assert "nobody measured reach, payload" in first.caution
    assert "stiffness" not in first.caution
    edit(
        folder,
        lambda d: [
            one.update(measured=True) for one in d.values() if isinstance(one, dict) and "measured" in one
        ],
    )
    assert _load.__wrapped__(folder / "robot.yaml").caution == ""


def test_limits_may_narrow_the_urdf(folder):
    edit(folder, lambda d: d["limits"].update(lower=[-90, -60, -170, -200, -100, -200]))
    assert np.degrees(load_robot(folder).lower) == pytest.approx([-90, -60, -170, -200, -100, -200])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d.update(schema="doormill/robot/9"), "doormill/robot/1"),
        (lambda d: d.pop("stiffness"), "no figure 'stiffness'"),
        (lambda d: d["stiffness"].pop("measured"), "'stiffness' has source"),
        (lambda d: d["payload"].update(source=""), "'payload' has source"),
        (lambda d: d["stiffness"].update(value=[1, 2, 3, 4, 5]), "6 finite numbers"),
        (lambda d: d["stiffness"].update(value=[1, 2, 3, 4, 5, -6]), "positive"),
        (lambda d: d["stiffness"].update(value="soft"), "6 finite numbers"),
        (lambda d: d["reach"].update(value=float("nan")), "positive"),
        (lambda d: d["limits"].update(upper=[180, 95, 70, 300, 120, 300]), "joint 2 .* 95.000"),
        (lambda d: d["limits"].update(upper=[180, -70, 70, 300, 120, 300]), "joint 2"),
        (lambda d: d.update(urdf="missing.urdf"), "missing.urdf"),
    ],
)
def test_a_description_that_contradicts_itself_is_refused(folder, change, says):
    edit(folder, change)
    with pytest.raises(RobotDescriptionError, match=says):
        load_robot(folder)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("</robot>", "", "readable"),
        ('type="revolute"', 'type="prismatic"', "prismatic"),
        ('name="joint_6" type="revolute"', 'name="joint_6" type="fixed"', "6 moving joints"),
        ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "no length"),
        ('<axis xyz="0 0 1"/>', '<axis xyz="0 0"/>', "three finite numbers"),
        ('<child link="link_3"/>', '<child link="link_2"/>', "two joints"),
        ('<child link="link_3"/>', "<child/>", "no child link"),
        ('<parent link="link_1"/>', '<parent link="link_5"/>', "6 moving joints|loop"),
    ],
)
def test_a_urdf_that_is_no_six_axis_chain_is_refused(folder, old, new, says):
    path = folder / "robot.urdf"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(RobotDescriptionError, match=says):
        load_robot(folder)


def test_links_beside_the_chain_are_passed_by(folder):
    path = folder / "robot.urdf"
    extra = """
      <link name="cylinder"/><link name="base"/>
      <joint name="cylinder_joint" type="revolute"><parent link="link_1"/><child link="cylinder"/>
        <axis xyz="0 1 0"/><mimic joint="joint_2" multiplier="-0.25"/><limit lower="-3" upper="3"/></joint>
      <joint name="base_joint" type="fixed"><parent link="base_link"/><child link="base"/></joint></robot>"""
    path.write_text(path.read_text(encoding="utf-8").replace("</robot>", extra), encoding="utf-8")
    loaded = load_robot(folder)
    assert loaded.flange_link == "flange"
    np.testing.assert_array_equal(loaded.dh, load_robot("irb6600_175_255").dh)


def test_an_unknown_name_says_what_ships():
    with pytest.raises(RobotDescriptionError, match="irb6600_175_255, irb6700_235_265"):
        load_robot("irb9999")


def test_any_six_axis_robot_loads_even_without_a_closed_form_inverse(tmp_path):
    # An arm of another kind: three parallel axes, no spherical wrist, axes along z after rpy turns.
    lines = []
    origins = [
        ("0 0 0.128", "0 0 0"),
        ("0 0.176 0", "0 1.5707963267948966 0"),
        ("0 -0.128 0.612", "0 0 0"),
        ("0 0 0.572", "0 1.5707963267948966 0"),
        ("0 0.116 0", "0 0 0"),
        ("0 0 0.116", "0 0 0"),
    ]
    axes = ["0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 1", "0 1 0"]
    for joint, ((xyz, rpy), axis) in enumerate(zip(origins, axes, strict=True), start=1):
        parent = "base_link" if joint == 1 else f"link_{joint - 1}"
        lines.append(
            f'<link name="link_{joint}"/><joint name="joint_{joint}" type="revolute">'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><parent link="{parent}"/><child link="link_{joint}"/>'
            f'<axis xyz="{axis}"/><limit lower="-6.29" upper="6.29" velocity="2" effort="0"/></joint>'
        )
    flange = (
        '<link name="tool0"/><joint name="flange" type="fixed"><parent link="link_6"/><child link="tool0"/>'
        '<origin xyz="0 0.092 0" rpy="-1.5707963267948966 0 0"/></joint>'
    )
    (tmp_path / "robot.urdf").write_text(
        f'<robot name="arm"><link name="base_link"/>{"".join(lines)}{flange}</robot>', encoding="utf-8"
    )
    document = yaml.safe_load(
        resource("config/robots/irb6600_175_255/robot.yaml").read_text(encoding="utf-8")
    )
    document["limits"].update(lower=[-360] * 6, upper=[360] * 6)
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    arm = load_robot(tmp_path)
    ours, pinocchio = Kinematics(arm), PinocchioKinematics(arm)
    for q in np.random.default_rng(5).uniform(-np.pi, np.pi, (50, 6)):
        np.testing.assert_allclose(ours.forward(q), pinocchio.forward(q), atol=1e-12)
        np.testing.assert_allclose(ours.hessian(q), pinocchio.hessian(q), atol=1e-12)
    with pytest.raises(GeometryError, match="no closed-form inverse"):
        inverse(arm, ours.forward(np.zeros(6)))
