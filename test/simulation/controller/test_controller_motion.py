"""The virtual controller's motion: look-ahead, zones, arcs, configurations, supervision."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller import clock as clock_module
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.motions.curves import TcpArc, TcpLine
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.moves import MotionContext
from doormill_ros.simulation.controller.rapid.errors import (
    RapidMotionError,
    RapidRuntimeError,
    RapidStoppedError,
)
from doormill_ros.simulation.controller.records.process import Process, no_wrench
from support.configuration import conf_data
from support.inverse_kinematics import inverse
from support.waiting import LIMIT

FREE, ONE = "[9E9,9E9,9E9,9E9,9E9,9E9]", "[1,0,0,0]"
#: Target a: tool straight ahead, 1.5 m in front of the robot, at the height of its shoulder.
DATA = """
PERS tooldata tMill:=[TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,120],[1,0,0,0],0,0,0]];
CONST robtarget a:=[[1500,0,1000],[0.7071068,0,0.7071068,0],[0,0,0,{cfx}],[9E9,9E9,9E9,9E9,9E9,9E9]];
"""


@pytest.fixture(scope="module")
def start(arm) -> np.ndarray:
    """Joint angles at target a, axis 4 turned by a few degrees so that no axis is on a border."""
    T = np.array([[0, 0, 1, 1.25], [0, 1, 0, 0.0], [-1, 0, 0, 1.0], [0, 0, 0, 1.0]])
    branches = arm.branches(T[None])[0]
    within = [q for q in branches if not np.isnan(q[0]) and arm.within_limits(q[None])[0]]
    good = [q for q in within if arm.conf_of(q)[3] in (0, 1)]
    return min(good, key=lambda q: np.abs(q[3]))


@pytest.fixture
def run(tmp_path: Path, controller, start, arm):
    """Run statements from target a; gives the controller."""

    def run_(body: str, declarations: str = "", go: bool = True, **kwargs):
        cfx = arm.conf_of(start)[3]
        module = tmp_path / "motion.mod"
        head = f"MODULE motion\n{DATA.format(cfx=cfx)}\n{declarations}\nPROC main()\nConfL\\Off;\n"
        module.write_text(f"{head}{body}\nENDPROC\nENDMODULE\n")
        robot = controller(modules=[module], expected_door=None, start=start, **kwargs)
        if go:
            robot.run()
        return robot

    return run_


def points(robot) -> np.ndarray:
    """Path of the tool in mm relative to target a."""
    return robot.executed_path().T_base_tool_commanded[:, :3, 3] * 1e3 - [1500, 0, 1000]


def closest(robot, point) -> float:
    """How near the path comes to a point given relative to target a [mm]."""
    p = points(robot)
    a, b = p[:-1], p[1:]
    step = b - a
    square = np.maximum((step**2).sum(axis=1), 1e-12)
    s = np.clip(((np.array(point) - a) * step).sum(axis=1) / square, 0, 1)
    return float(np.linalg.norm(a + s[:, None] * step - point, axis=1).min())


# Independent kinematics


@pytest.mark.parametrize("name", ["irb6600_175_255", "irb6700_235_265"])
def test_the_controllers_kinematics_agree_with_the_robot_package(name):
    """Two implementations by different ways: closed form here, the other one in doormill_ros.robot."""
    robot = load_robot(name)
    arm = ControllerArm(robot.dh, robot.lower, robot.upper)
    rng = np.random.default_rng(7)
    compared = 0
    for q in rng.uniform(robot.lower, robot.upper, (60, 6)):
        T = arm.forward(q)
        np.testing.assert_allclose(
            arm.forward(arm.in_configuration(T[0], arm.conf_of(q)[:3], arm.conf_of(q)[3])), T, atol=1e-9
        )
        conf = conf_data(q, robot)
        assert arm.conf_of(q) == (conf.cf1, conf.cf4, conf.cf6, conf.cfx)
        for other in inverse(robot, T[0]):
            ours = arm.branches(T)[0]
            error = np.abs(np.exp(1j * ours) - np.exp(1j * other)).max(axis=1)
            assert np.nanmin(error) < 1e-6
            compared += 1
    assert compared > 200


# Program pointer and zones


def test_the_program_pointer_runs_ahead_of_a_fly_by_point(run):
    """The signal comes while the robot is still on its way: after fine it would not."""
    seen = {}

    def watch(c):
        if c.read_signal("doBlowOff") == 1.0 and "at" not in seen:
            seen["at"] = c.now()

    robot = run(
        "MoveL Offs(a,0,100,0),v100,z10,tMill;\nSet doBlowOff;\nMoveL a,v100,fine,tMill;", on_time=watch
    )
    assert seen["at"] < 0.1
    assert robot.executed_path().time[-1] > 1.5


ENDS = ("fine,tMill;", "z10,tMill;\nWaitRob\\InPos;", "z10,tMill;\nWaitTime\\InPos,0;")


@pytest.mark.parametrize("end", ENDS)
def test_a_stop_point_holds_the_program_pointer(run, end):
    robot = run(f"MoveL Offs(a,0,100,0),v100,{end}\nSet doBlowOff;\nMoveL a,v100,fine,tMill;", go=False)
    set_at, write = [], robot.cell.write

    def watched(name, value, now):
        set_at.append((now, robot.executed_count))
        write(name, value, now)

    robot.cell.write = watched
    robot.run()
    [(moment, count)] = set_at
    assert moment >= 1.0
    np.testing.assert_allclose(points(robot)[count - 1], [0, 100, 0], atol=1e-3)


def test_the_pointer_is_at_most_three_motions_ahead(run):
    """With three motions waiting the fourth holds the pointer until one has been taken up."""
    ahead = []

    def watch(c):
        if c.executed_count:
            ahead.append(c.motion_count - 1 - c.executed_motion)

    numbered = Process(lambda _program, count: MotionContext(index=count), no_wrench)
    body = "FOR i FROM 1 TO 12 DO MoveL Offs(a,0,10*i,0),v100,z1,tMill; ENDFOR MoveL a,v500,fine,tMill;"
    robot = run(body, on_time=watch, process=numbered)
    assert max(ahead) == 3 + 1
    assert ahead[-1] == 0
    assert robot.motion_count == 13


@pytest.mark.parametrize(
    ("zone", "radius"), [("fine", 0.0), ("z0", 0.3), ("z1", 1.0), ("z5", 5.0), ("z10", 10.0)]
)
def test_corners_are_cut_by_half_a_zone_on_a_parabola(run, zone, radius):
    """A right angle: the parabola passes the corner at radius * sqrt(2) / 4 (control polygon)."""
    robot = run(f"MoveL Offs(a,0,50,0),v100,{zone},tMill;\nMoveL Offs(a,0,50,50),v100,fine,tMill;")
    assert closest(robot, (0, 50, 0)) == pytest.approx(radius * np.sqrt(2) / 4, abs=2e-3 + 0.01 * radius)
    assert closest(robot, (0, 50 - radius, 0)) < 2e-3  # the straight line is kept up to the zone
    assert closest(robot, (0, 50, radius)) < 2e-3


def test_zones_are_cut_to_half_of_a_short_motion(run):
    robot = run("MoveL Offs(a,0,10,0),v100,z50,tMill;\nMoveL Offs(a,0,10,50),v100,fine,tMill;")
    assert closest(robot, (0, 10, 0)) == pytest.approx(5 * np.sqrt(2) / 4, abs=0.05)


def test_a_fly_by_point_without_next_motion_becomes_a_stop_point_and_is_logged(run):
    robot = run("MoveL Offs(a,0,50,0),v100,z10,tMill;\nWaitTime 2;\nMoveL a,v100,fine,tMill;")
    assert closest(robot, (0, 50, 0)) < 1e-3
    assert [entry.title for entry in robot.event_log] == ["corner path"]
    assert "motion.mod, line 9" in robot.event_log[0].text


def test_speed_is_that_of_the_tool_centre_point(run):
    path = run("MoveL Offs(a,0,100,0),v50,fine,tMill;").executed_path()
    moving = np.linalg.norm(np.diff(path.T_base_tool_commanded[:, :3, 3], axis=0), axis=1) > 0
    # At an even acceleration of 2 m/s^2 setting off and braking cost half of 50/2000 s each.
    assert path.time[1:][moving][-1] - path.time[:-1][moving][0] == pytest.approx(100 / 50 + 0.025, abs=1e-3)
    step = np.linalg.norm(np.diff(path.T_base_tool_commanded[:, :3, 3], axis=0), axis=1)[moving]
    assert (step / np.diff(path.time)[moving]).max() == pytest.approx(0.05, rel=1e-6)


def test_a_joint_that_cannot_follow_slows_the_motion_down(run, arm):
    agile = ControllerLimits(acceleration=200.0, ramp=0.01)
    path = run("MoveL Offs(a,0,400,0),v5000,fine,tMill;", limits=agile).executed_path()
    velocity = np.abs(np.diff(path.q, axis=0)) / np.maximum(np.diff(path.time), 1e-9)[:, None]
    assert np.all(velocity <= arm.max_velocity * (1 + 1e-6))
    assert (velocity / arm.max_velocity).max() > 0.99


# Arcs


def test_an_arc_keeps_its_radius(run):
    robot = run("MoveC Offs(a,0,20,20),Offs(a,0,0,40),v50,fine,tMill;")
    p = points(robot)
    np.testing.assert_allclose(np.linalg.norm(p - [0, 0, 20], axis=1), 20.0, atol=1e-3)
    assert p[:, 1].max() == pytest.approx(20.0, abs=1e-2)  # through the circle point, not the other way
    assert p[:, 1].min() > -1e-3
    np.testing.assert_allclose(p[-1], [0, 0, 40], atol=1e-3)


@pytest.mark.parametrize(
    ("via", "to", "words"),
    [
        ("0,0.05,0", "0,0,40", "circle point is 0.050 mm from the start"),
        ("0,20,20", "0,0,0.05", "end point is 0.050 mm from the start"),
        ("0,10,0", "0,20,0.1", "deg apart seen from the start"),
        ("0,20,-20", "0,-19,-24", "arc is 25.* deg long, allowed are 240"),
    ],
)
def test_limits_of_circles(run, via, to, words):
    robot = run(f"MoveC Offs(a,{via}),Offs(a,{to}),v50,fine,tMill;", go=False)
    with pytest.raises(RapidMotionError, match=words) as caught:
        robot.run()
    assert caught.value.data["line"] == 9
    assert robot.executed_count == 0


def test_arcs_match_lines_drawn_through_their_points():
    """A quarter of a circle has its middle where geometry says."""
    poses = []
    for p in ((0.0, 0.0, 0.0), (0.0, 1.0 - np.sqrt(0.5), np.sqrt(0.5)), (0.0, 1.0, 1.0)):
        T = np.eye(4)
        T[:3, 3] = p
        poses.append(T)
    arc = TcpArc(*poses)
    assert arc.radius == pytest.approx(1.0)
    assert arc.length == pytest.approx(np.pi / 2)
    np.testing.assert_allclose(arc.poses(np.array([0.5]))[0, :3, 3], poses[1][:3, 3], atol=1e-12)
    assert TcpLine(poses[0], poses[2]).length == pytest.approx(np.sqrt(2))


# Configurations and supervision


def conf_target(cf: str) -> str:
    return f"CONST robtarget b:=[[1500,100,1000],[0.7071068,0,0.7071068,0],[{cf}],[9E9,9E9,9E9,9E9,9E9,9E9]];"


def test_a_linear_motion_into_another_configuration_is_stopped_unless_conf_l_is_off(run, arm, start):
    wrong = (arm.conf_of(start)[3] + 2) % 8
    robot = run("ConfL\\On;\nMoveL b,v100,fine,tMill;", conf_target(f"0,0,0,{wrong}"), go=False)
    with pytest.raises(RapidMotionError, match=r"motion.mod, line 10: MoveL: the motion ends"):
        robot.run()
    assert run("MoveL b,v100,fine,tMill;", conf_target(f"0,0,0,{wrong}")).executed_count > 0


def test_a_joint_motion_takes_the_configuration_it_is_told(run, arm, start):
    T = np.array([[0, 0, 1, 1.25], [0, 1, 0, 0.1], [-1, 0, 0, 1.0], [0, 0, 0, 1.0]])
    found = set()
    for cfx in range(8):
        for q in [arm.branches(T[None])[0, cfx]]:
            if np.isnan(q[1]) or not arm.within_limits(q[None])[0]:
                continue
            cf1, cf4, cf6, own = arm.conf_of(q)
            robot = run("MoveJ b,v500,fine,tMill;", conf_target(f"{cf1},{cf4},{cf6},{own}"))
            np.testing.assert_allclose(robot.q, q, atol=1e-5)
            found.add(own)
    assert len(found) >= 2


@pytest.mark.parametrize(
    ("body", "declare", "words"),
    [
        ("MoveJ b,v100,fine,tMill;", conf_target("0,0,0,6"), "cannot be reached in configuration"),
        ("MoveL Offs(a,3000,0,0),v100,fine,tMill;", "", "leaves the robot's reach"),
        ("MoveL Offs(a,0,0,-2400),v100,fine,tMill;", "", "would be at|leaves the robot's reach|singularity"),
        ("MoveJ b,v100,fine,tMill;", conf_target("0.5,0,0,0"), "confdata"),
        ("MoveAbsJ j,v100,fine,tMill;", f"CONST jointtarget j:=[[0,200,0,0,0,0],{FREE}];", "beyond"),
        ("MoveL a,[0,500,5000,1000],fine,tMill;", "", "speed is 0 mm/s"),
        ("MoveL c,v100,fine,tMill;", f"CONST robtarget c:=[[1500,0,1000],[1,1,0,0],[0,0,0,0],{FREE}];", "unit"),
        ("MoveL a,v100,fine,tNone;", f"PERS tooldata tNone:=[TRUE,[[0,0,250],{ONE}],[0,[0,0,0],{ONE},0,0,0]];", "load"),
    ],
)  # fmt: skip
def test_motions_that_the_supervision_stops(run, body, declare, words):
    robot = run(body, declare, go=False)
    with pytest.raises(RapidMotionError, match=words):
        robot.run()
    assert robot.event_log[-1].title == "motion supervision"


def test_a_quaternion_that_is_slightly_off_is_reported(run):
    off = "CONST robtarget c:=[[1500,50,1000],[0.7072,0,0.7072,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,0]];"
    robot = run("MoveL c,v100,fine,tMill;", off)
    assert {entry.title for entry in robot.event_log} == {"quaternion", "external axes"}


def test_tool_and_work_object_move_the_target(run):
    declare = 'PERS wobjdata w:=[FALSE,TRUE,"",[[0,50,0],[1,0,0,0]],[[0,0,20],[1,0,0,0]]];'
    np.testing.assert_allclose(
        points(run("MoveL a,v100,fine,tMill\\WObj:=w;", declare))[-1], [0, 50, 20], atol=2e-3
    )
    # A tool that is believed 10 mm longer than the one that is mounted ends up 10 mm short.
    longer = "PERS tooldata t2:=[TRUE,[[0,0,260],[1,0,0,0]],[20,[0,0,120],[1,0,0,0],0,0,0]];"
    np.testing.assert_allclose(points(run("MoveL a,v100,fine,t2;", longer))[-1], [-10, 0, 0], atol=2e-3)


def test_the_robot_knows_where_it_stands(run):
    robot = run("MoveL Offs(a,0,30,0),v100,fine,tMill;\np:=CRobT(\\Tool:=tMill);", "VAR robtarget p;")
    np.testing.assert_allclose(robot.program.read("p")[0], [1500, 30, 1000], atol=2e-3)


# Stopping, waiting, time


def test_stop_move_and_clear_path_leave_the_robot_where_it_is(run):
    moves = "MoveL Offs(a,0,100,0),v100,z1,tMill;\nMoveL a,v100,z1,tMill;\n"
    body = moves + "WaitTime 0.5;\nStopMove;\nClearPath;\nStartMove;"
    p = points(run(body))
    assert p[-1][1] == pytest.approx(45, abs=3)  # half a second less the setting off, at 100 mm/s
    assert np.abs(p[:, [0, 2]]).max() < 1e-2


def test_the_spindle_takes_its_time_and_limits_of_time_are_kept(run):
    robot = run("Set doSpindleOn;\nWaitDI diSpindleAtSpeed,1\\MaxTime:=5;")
    assert robot.now() == pytest.approx(1.5, abs=0.05)
    robot = run("Set doSpindleOn;\nWaitDI diSpindleAtSpeed,1\\MaxTime:=1;", go=False)
    with pytest.raises(RapidRuntimeError, match="ERR_WAIT_MAXTIME"):
        robot.run()
    assert robot.now() == pytest.approx(1.0, abs=0.05)


def test_waiting_for_ever_ends_when_patience_does(run):
    robot = run("WaitDO doPathReady,1;", go=False, on_wait=lambda c: None, patience=3.0)
    with pytest.raises(RapidStoppedError, match=r"waited 3\.\d s for a signal"):
        robot.run()


def test_a_program_can_be_stopped_from_another_thread(run):
    robot = run("WHILE TRUE DO WaitTime 0.01; ENDWHILE", go=False)
    threading.Timer(0.1, robot.stop).start()
    with pytest.raises(RapidStoppedError, match="from outside"):
        robot.run()


def test_a_loop_that_waits_for_nothing_can_be_stopped_too(run):
    robot = run("WHILE TRUE DO ENDWHILE", go=False)
    threading.Timer(0.1, robot.stop).start()
    with pytest.raises(RapidStoppedError):
        robot.run()


def test_signals_in_a_folder_reach_a_program_in_another_thread(run, tmp_path):
    io = FolderIo(tmp_path)
    robot = run(
        "Set doPathRequest;\nWaitDO doPathReady,1\\MaxTime:=600;\nReset doPathRequest;",
        go=False,
        io=io,
        on_wait=None,
    )

    def pc():
        other = FolderIo(tmp_path)
        while other.read("doPathRequest") == 0:
            time.sleep(0.002)
        other.write("doPathReady", 1)

    thread = threading.Thread(target=pc, daemon=True)
    thread.start()
    robot.run()
    thread.join(LIMIT)
    assert io.read("doPathRequest") == 0
    assert (tmp_path / "io" / "doPathReady").read_bytes() == b"1"


@pytest.mark.parametrize("scale", [None, 1.0, 20.0])
def test_motion_takes_no_real_time_unless_a_scale_is_set(run, monkeypatch, scale):
    slept = []
    monkeypatch.setattr(clock_module, "time", SimpleNamespace(sleep=slept.append))
    robot = run("MoveL Offs(a,0,100,0),v10,fine,tMill;", time_scale=scale)
    assert robot.now() > 10.0
    assert sum(slept) == pytest.approx(robot.now() / scale if scale else 0.0)


def test_digital_outputs_that_do_not_exist_or_are_inputs_are_refused(run):
    from doormill_ros.simulation.controller.rapid.errors import RapidProgramError

    with pytest.raises(RapidProgramError, match="no configured signal"):
        run("Set doNothing;")
    with pytest.raises(RapidProgramError, match="signaldi"):
        run("Set diDoorClamped;")
