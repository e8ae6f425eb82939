"""Targets -> file -> executed by our module on the virtual controller -> the same targets."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.abb.target_file.trailer import ANGLE_DECIMALS
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import apply_twist, inverse, quaternion_wxyz, twist_between
from doormill_ros.robot.configuration import ConfData
from doormill_ros.simulation.controller.records.process import module_process
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.units import RPM
from support.rapid_bench import reading_modules

HALF_ULP_OF_ONE = 2.0**-25
RUNS = itertools.count(1)
LETTERS = {MotionKind.ABSOLUTE: "A", MotionKind.LINEAR: "L"}  #: what a file calls them


def assert_same_target(told, target: Target, line) -> None:
    """A robtarget against the pose it was written from."""
    trans, rot, conf, extax = told
    wanted = target.T_base_tool_corrected[:3, 3] * 1e3
    spacing = np.spacing(np.abs(wanted).astype(np.float32)).astype(float)
    allowed = line.position_resolution * 1e3 + 0.5 * spacing + 1e-9
    assert np.all(np.abs(np.array(trans) - wanted) <= allowed)
    assert np.all(allowed <= 0.5e-3 + 0.5 * spacing + 1e-9)  # never coarser than a micrometre
    wanted_q = quaternion_wxyz(target.T_base_tool_corrected)
    # q and -q are one orientation: near w = 0 the canonical sign may fall on either side.
    error = min(np.abs(np.array(rot) - wanted_q).max(), np.abs(np.array(rot) + wanted_q).max())
    assert error <= line.quaternion_resolution + HALF_ULP_OF_ONE + 1e-12
    assert line.quaternion_resolution <= 0.5e-6
    assert tuple(conf) == (target.conf.cf1, target.conf.cf4, target.conf.cf6, target.conf.cfx)
    assert all(e == float(np.float32(9e9)) for e in extax)


@st.composite
def joint_angles(draw, regular: bool = False):
    """Joint angles within the robot's range, away from its limits, and from singularities if asked."""
    ranges = ((-170, 170), (-60, 80), (-170, 65), (-290, 290), (-115, 115), (-290, 290))
    degrees = [draw(st.floats(low, high, allow_nan=False)) for low, high in ranges]
    if regular:
        # Wrist 15 to 115 deg, elbow 60 deg to either side of the right angle, wrist centre out in front.
        degrees[4] = draw(st.sampled_from((-1.0, 1.0))) * draw(st.floats(15, 115))
        degrees[1], degrees[2] = draw(st.floats(-30, 60)), draw(st.floats(-60, 40))
    return np.radians(degrees)


@pytest.fixture(scope="module")
def reader(tmp_path_factory, arm):
    """One controller whose ReadTargetFile is called again and again."""
    from doormill_ros.simulation.controller.configuration.installed import read_installed
    from doormill_ros.simulation.controller.controller import VirtualController

    home = tmp_path_factory.mktemp("home")
    return VirtualController(home, arm, installed=read_installed(reading_modules(home)))


def assert_same_joints(told, q) -> None:
    """A jointtarget against the joint angles it was written from."""
    robax, extax = told
    wanted = np.degrees(q)
    allowed = 0.5 * 10.0**-ANGLE_DECIMALS + 0.5 * np.spacing(np.abs(wanted).astype(np.float32)).astype(float)
    assert np.all(np.abs(np.array(robax) - wanted) <= allowed + 1e-9)
    assert all(e == float(np.float32(9e9)) for e in extax)


def program_of(arm, angles) -> MillingProgram:
    """To these angles, of up to three features, and to targets there; each way home passes one or two points."""
    layout = load_layout()
    T_flange_tool = layout.T_flange_tool
    none = np.zeros(6)
    targets = []
    for i, q in enumerate(angles):
        T = arm.forward(q)[0] @ T_flange_tool
        targets.append(Target(str(i), T, T, q, ConfData(*arm.conf_of(q)), none, none))
    motions = [
        Motion(kind, i, None, 0.3 + 0.01 * i, "fine", f"f{i % 3}", False, none, 300.0)
        for i in range(len(targets))
        for kind in LETTERS
    ]
    features = min(3, len(angles))
    escapes = tuple(range(i, min(i + 2, len(angles))) for i in range(features))
    return MillingProgram(
        "door 7",
        3,
        tuple(targets),
        tuple(motions),
        points=tuple(angles),
        home=layout.home,
        escapes=escapes,
        tool=layout.T_flange_tool,
    )


@settings(max_examples=25)
@given(angles=st.lists(joint_angles(), min_size=1, max_size=6), run=st.integers(0, 10**9))
def test_any_targets_arrive_in_the_module_as_they_were_written(angles, run, arm, reader):
    program = program_of(arm, angles)
    data = render_target_file(program, f"run-{run}")
    (reader.home / "Hei2.txt").write_bytes(data)
    (reader.home / "Hei2.run").write_text(f"run-{run}\n0\n")
    reader.program.run("ReadAndTell")
    assert reader.program.read("accepted") is True
    file = read_target_file(data)
    assert reader.program.read("targetCount") == len(program.targets) == len(file.targets)
    told = reader.program.read("targets")
    for i, (target, line) in enumerate(zip(program.targets, file.targets, strict=True)):
        assert_same_target(told[i], target, line)
    assert reader.program.read("doorId") == "door 7"
    assert reader.program.read("recipeVersion") == 3
    assert reader.program.read("pointCount") == len(program.points)
    for told_joints, q in zip(reader.program.read("points"), program.points, strict=False):
        assert_same_joints(told_joints, q)
    ranges = reader.program.read("escapes")[: len(program.escapes)]
    assert [tuple(r) for r in ranges] == [(escape.start + 1, escape.stop) for escape in program.escapes]
    features = reader.program.read("features")
    assert reader.program.read("moveCount") == len(program.motions)
    for row, motion in zip(reader.program.read("moves"), program.motions, strict=False):
        kind, target, via, speed, zone, feature, cutting, spindle = row
        assert (kind, target - 1, via) == (LETTERS[motion.kind], motion.target, 0)
        assert (zone, cutting) == (motion.zone, motion.cutting)
        assert abs(speed - motion.speed * 1e3) <= 0.5e-3 + 1e-4
        assert features[int(feature) - 1] == motion.feature
        assert abs(spindle - motion.spindle_speed / RPM) <= 0.5e-3 + 3e-4


@settings(max_examples=15)
@given(angles=st.lists(joint_angles(regular=True), min_size=1, max_size=4))
def test_the_robot_goes_where_the_file_says_in_the_configuration_it_says(angles, arm, controller):
    program = program_of(arm, angles)
    data = render_target_file(program, f"run-{next(RUNS)}")  # no run is milled twice
    robot = controller(process=module_process(program))
    (robot.home / "Hei2.txt").write_bytes(data)
    robot.run()
    assert robot.moves, (robot.pendant_lines, robot.event_log)
    *commanded, home = robot.moves  # of its own the module makes the way home alone
    assert [m.kind for m in commanded] == ["MoveAbsJ", "MoveL"] * len(program.targets)
    assert home.kind == "MoveAbsJ"
    assert_same_joints(home.target, program.home)
    path = robot.executed_path()
    for i, (move, target, line) in enumerate(
        zip(commanded[1::2], program.targets, read_target_file(data).targets, strict=True)
    ):
        assert_same_joints(commanded[2 * i].target, program.points[i])
        assert_same_target(move.target, target, line)
        last = np.flatnonzero(path.motion == 2 * i + 1)[-1]
        reached = path.T_base_tool_commanded[last]
        assert np.linalg.norm(reached[:3, 3] - target.T_base_tool_corrected[:3, 3]) < 2e-6
        # Micrometres and microradians in the file; no axis magnifies them a hundredfold there.
        assert np.abs(path.q[last] - target.q).max() < 1e-4


DOORS = ("thesis_190_0deg", "thesis_190_2deg", "thesis_1350_0deg", "thesis_1350_2deg")


@pytest.mark.parametrize("name", DOORS)
def test_generated_doors_are_executed_motion_by_motion(name, door, arm, controller):
    program = door(name, 0.002, -0.004, 0.005)
    data = render_target_file(program, "run-1")
    robot = controller(truth=TruthRobot(arm.dh), process=module_process(program))
    (robot.home / "Hei2.txt").write_bytes(data)
    robot.run()
    assert [entry for entry in robot.event_log if entry.kind != "information"] == []
    lines = read_target_file(data).targets
    *moves, home = robot.moves  # of its own the module makes the way home alone
    assert home.kind == "MoveAbsJ"
    assert_same_joints(home.target, program.home)
    assert moves[0].kind == "MoveAbsJ"
    assert [m.kind for m in moves] == [m.kind.value for m in program.motions]
    for move, motion in zip(moves, program.motions, strict=True):
        if motion.kind is MotionKind.ABSOLUTE:
            assert_same_joints(move.target, program.points[motion.target])
        else:
            assert_same_target(move.target, program.targets[motion.target], lines[motion.target])
        if motion.via is not None:
            assert_same_target(move.via, program.targets[motion.via], lines[motion.via])
        assert move.speed[0] == pytest.approx(motion.speed * 1e3, abs=1e-3)
    path = robot.executed_path()
    assert set(path.motion[path.motion >= 0]) == set(range(len(program.motions)))
    cutting = path.cutting
    assert set(path.feature[cutting]) == {m.feature for m in program.motions if m.cutting}
    steps = np.linalg.norm(np.diff(path.T_base_tool_commanded[:, :3, 3], axis=0), axis=1)
    assert steps[cutting[:-1] & cutting[1:]].max() <= 1.0e-3
    for i, motion in enumerate(program.motions):
        if motion.cutting:
            np.testing.assert_array_equal(
                path.wrench[path.motion == i], np.tile(motion.wrench, (sum(path.motion == i), 1))
            )


def test_the_compliant_robot_is_bent_onto_targets_that_were_corrected_for_it(arm, controller):
    """File, controller, wrench and truth together: what was bent away beforehand is bent back."""
    truth, T_flange_tool = TruthRobot(arm.dh), load_layout().T_flange_tool
    wrench = np.array([-209.0, 29.0, 12.0, -5.0, -43.0, 3.0])  # left line of table 4.8
    none = np.zeros(6)
    q = np.radians([5.0, 20.0, 10.0, 3.0, -30.0, 2.0])
    first = arm.forward(q)[0] @ T_flange_tool
    second = first.copy()
    second[2, 3] -= 0.090
    targets = []
    for name, nominal in (("a", first), ("b", second)):
        told = nominal.copy()
        for _ in range(4):
            joints = arm.nearest((told @ inverse(T_flange_tool))[None], q)
            actual = truth.deflected(joints, wrench, T_flange_tool[:3, 3])[0] @ T_flange_tool
            told = apply_twist(told, -twist_between(nominal, actual))
        targets.append(
            Target(name, nominal, told, joints[0], ConfData(*arm.conf_of(joints[0])), wrench, none)
        )
    motions = (
        Motion(MotionKind.ABSOLUTE, 0, None, 0.2, "fine", "", False, none, 335.0),
        Motion(MotionKind.LINEAR, 0, None, 0.2, "fine", "edge", False, none, 335.0),
        Motion(MotionKind.LINEAR, 1, None, 0.05, "fine", "edge", True, wrench, 335.0),
    )
    program = MillingProgram(
        "door",
        1,
        tuple(targets),
        motions,
        points=(targets[0].q,),
        home=load_layout().home,
        escapes=(range(1),),
        tool=T_flange_tool,
    )
    robot = controller(truth=truth, process=module_process(program))
    (robot.home / "Hei2.txt").write_bytes(render_target_file(program, "run-1"))
    robot.run()
    path = robot.executed_path()
    cut = path.motion == 2
    bent = np.linalg.norm((path.T_base_tool - path.T_base_tool_commanded)[:, :3, 3], axis=1)
    assert bent[cut].min() > 1e-4
    assert bent[~path.cutting].max() < 1e-9
    ends = path.T_base_tool[cut][[0, -1], :3, 3]
    # Half of the last decimal and float32, in each of three coordinates.
    assert np.linalg.norm(ends - [first[:3, 3], second[:3, 3]], axis=1).max() < 1.5e-6
    # Between its ends the correction is a straight line, the bending is not quite one.
    aside = path.T_base_tool[cut, :3, 3][:, :2] - first[:2, 3]
    assert np.linalg.norm(aside, axis=1).max() < 0.02 * bent[cut].max()
