"""Stops, emergency stops, guard, power, override and modes: what the panel orders, and what the robot does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.operation.configuration import read_system_outputs
from doormill_ros.simulation.controller.operation.states import (
    ControllerState,
    ExecutionState,
    OperatingMode,
    StopCause,
    StopMode,
)
from doormill_ros.simulation.controller.rapid.errors import (
    OrderRefusedError,
    RapidMotionError,
    RapidRuntimeError,
    SignalError,
)

DATA = """PERS tooldata tMill:=[TRUE,[[0,0,250],[1,0,0,0]],[20,[0,0,120],[1,0,0,0],0,0,0]];
VAR robtarget a; VAR num count; PERS num kept:=1;
PROC GoOn() count:=count+1; ENDPROC"""
#: 600 mm at 100 mm/s along y, in two motions.
BODY = """kept:=kept+1; count:=count+10; ConfL\\Off; a:=CRobT(\\Tool:=tMill);
MoveL Offs(a,0,300,0),v100,z1,tMill; MoveL Offs(a,0,600,0),v100,fine,tMill; TPWrite "there";"""
EIO = """EIO:CFG_1.0:6:1::
SYSSIG_OUT:

      -Status "CycleOn" -Signal "soCycleOn"
#
EIO_CROSS:

      -Name "Run" -Res "doRun" -Act1 "doWanted" -Oper1 "AND" -Act2 "soCycleOn"
#
EIO_SIGNAL:

      -Name "doWanted" -SignalType "DO"

      -Name "doSafe" -SignalType "DO" -SafeLevel "SafetySafeLevel"

      -Name "doRun" -SignalType "DO" -Access "ReadOnly"

      -Name "soCycleOn" -SignalType "DO" -Access "ReadOnly"
"""


@pytest.fixture
def make(tmp_path: Path, controller):
    """A controller on a module with this body; `operator` is called while the program stands."""

    def make_(body: str = BODY, operator=None, rest: str = "", **kwargs):
        (tmp_path / "EIO.cfg").write_text(EIO)
        module = tmp_path / "operation.mod"
        module.write_text(f"MODULE operation\n{DATA}\nPROC main()\n{body}\nENDPROC\n{rest}\nENDMODULE\n")
        return controller(
            modules=[module],
            expected_door=None,
            io_configuration=tmp_path / "EIO.cfg",
            on_stopped=operator,
            **{"patience": 60.0, **kwargs},
        )

    return make_


def along(robot) -> np.ndarray:
    """Way of the tool from the start in x, y, z [mm]."""
    points = robot.executed_path().T_base_tool_commanded[:, :3, 3] * 1e3
    return points - points[0]


def off_line(robot) -> float:
    """Largest distance from the straight line [mm]."""
    return float(np.abs(along(robot)[:, [0, 2]]).max())


def start(robot) -> None:
    robot.panel.start()


def recover(robot) -> None:
    """Whatever it was: out of it, motors on, start."""
    panel = robot.panel
    panel.restore_power()
    panel.close_guard()
    panel.release_emergency_stop()
    panel.set_mode(OperatingMode.AUTO)
    panel.motors(True)
    panel.start()


# Stops and where the robot is then


@pytest.mark.parametrize(
    ("order", "cause", "state"),
    [
        (lambda p: p.stop(), StopCause.PROGRAM_STOP, ControllerState.MOTORS_ON),
        (lambda p: p.stop(StopMode.QUICK), StopCause.QUICK_STOP, ControllerState.MOTORS_ON),
        (lambda p: p.emergency_stop(0), StopCause.EMERGENCY_STOP, ControllerState.EMERGENCY_STOP),
        (lambda p: p.emergency_stop(1), StopCause.EMERGENCY_STOP, ControllerState.EMERGENCY_STOP),
        (lambda p: p.open_guard(), StopCause.GUARD_STOP, ControllerState.GUARD_STOP),
        (lambda p: p.motors(False), StopCause.MOTORS_OFF, ControllerState.MOTORS_OFF),
        (lambda p: p.set_mode(OperatingMode.MANUAL_FULL), StopCause.MODE_CHANGE, ControllerState.MOTORS_OFF),
        (lambda p: p.fail_power(), StopCause.POWER_FAILURE, ControllerState.INIT),
        (lambda p: p.warm_start(), StopCause.WARM_START, ControllerState.MOTORS_OFF),
    ],
)
def test_every_stop_keeps_the_pointer_and_the_path(make, order, cause, state):
    """Data live on, no cycle is begun anew, and the robot ends where it was going."""
    seen = []

    def operator(robot):
        seen.append((robot.panel.state, robot.q))
        if len(seen) == 50:
            recover(robot)

    robot = make(operator=operator)
    robot.panel.at(3.0, lambda: order(robot.panel))
    robot.run()
    first, last = seen[0][0], seen[49][0]
    assert (first.cause, first.controller, first.execution) == (cause, state, ExecutionState.STOPPED)
    assert not first.pointer_lost
    assert np.array_equal(seen[1][1], seen[49][1])
    assert (robot.program.read("count"), robot.program.read("kept")) == (10.0, 2.0)
    assert along(robot)[-1][1] == pytest.approx(600.0, abs=1e-3)
    assert robot.pendant_lines == ["there"]
    assert last.cause is cause
    assert robot.panel.state.cause is StopCause.ENDED


def test_an_ordered_stop_stays_on_the_path_and_brakes_within_what_physics_asks(make):
    robot = make(operator=start)
    robot.panel.at(3.0, robot.panel.stop)
    stood = []
    robot._on_time = lambda c: stood.append(c.now()) if not c.panel.running else None
    robot.run()
    assert off_line(robot) < 1e-2
    path = robot.executed_path()
    step = np.linalg.norm(np.diff(path.T_base_tool_commanded[:, :3, 3], axis=0), axis=1) * 1e3
    braking = (path.time[1:] > 3.0) & (path.time[1:] <= stood[0])
    # From 100 mm/s at 2 m/s^2 at most it takes v^2/2a = 2.5 mm, more where the wrist has to brake too.
    assert 2.0 < step[braking].sum() < 8.0


def test_without_power_the_arm_runs_off_its_path_and_comes_back_to_it(make):
    """Every brake alone: the tool leaves the line, the way back is logged, and then the line is kept."""
    robot = make(BODY.replace("v100", "v1000"), operator=recover)
    robot.panel.at(0.4, lambda: robot.panel.emergency_stop(0))
    robot.run()
    path = robot.executed_path()
    assert not path.driven.all()
    loose = np.flatnonzero(~path.driven)
    assert np.all(path.driven[loose[-1] + 1 :])
    assert np.linalg.norm(along(robot)[loose[-1]] - along(robot)[loose[0] - 1]) > 20.0
    assert [e.number for e in robot.event_log if e.number in (10052, 10053)] == [10052, 10053]
    assert along(robot)[-1][1] == pytest.approx(600.0, abs=1e-3)


def test_a_start_far_from_the_path_is_refused_until_the_pointer_is_moved(make):
    def operator(robot):
        if robot.panel.state.pointer_lost or any(e.title == "regain" for e in robot.event_log):
            robot.panel.pointer_to_main()
        recover(robot)

    robot = make(BODY.replace("v100", "v1000"), operator, limits=ControllerLimits(regain_distance=0.005))
    robot.panel.at(0.4, lambda: robot.panel.emergency_stop(0))
    robot.run()
    assert any("from its path, allowed are 5 mm" in e.text for e in robot.event_log)
    assert robot.program.read("count") == 10.0  # VAR begin anew
    assert robot.program.read("kept") == 3.0  # PERS do not


def test_stop_after_instruction_and_after_the_cycle(make):
    robot = make(operator=start)
    robot.panel.at(2.0, lambda: robot.panel.stop(StopMode.INSTRUCTION))
    places = []
    robot._on_time = lambda c: places.append(along(c)[-1][1]) if not c.panel.running else None
    robot.run()
    assert min(abs(place - 300.0) for place in places) < 0.5 or min(abs(p - 600.0) for p in places) < 1e-3
    robot = make(operator=start)
    robot.panel.at(2.0, lambda: robot.panel.stop(StopMode.CYCLE))
    robot.run(cycles=2)
    assert [e.number for e in robot.event_log if e.number in (10005, 10008)] == [10005, 10008]
    assert robot.program.read("kept") == 3.0


@pytest.mark.parametrize(("instruction", "stands_at"), [("Stop", 300.0), ("Break", 0.0)])
def test_a_program_that_stops_itself_waits_for_the_operator_and_goes_on_behind(make, instruction, stands_at):
    """Stop after the motions before it, Break at once; nothing is begun anew."""
    looks = []

    def operator(robot):
        looks.append((along(robot)[-1][1] if robot.executed_count else 0.0, robot.panel.state))
        if len(looks) == 50:
            robot.panel.start()

    robot = make(BODY.replace("v100,z1,tMill;", f"v100,z1,tMill; {instruction};"), operator)
    robot.run()
    (place, state), (last, _) = looks[0], looks[49]
    assert place == last == pytest.approx(stands_at, abs=5.0)
    assert (state.cause, state.pointer_lost) == (StopCause.PROGRAM_STOP, False)
    assert robot.pendant_lines == ["there"]
    assert (robot.program.read("count"), robot.program.read("kept")) == (10.0, 2.0)
    assert along(robot)[-1][1] == pytest.approx(600.0, abs=1e-3)
    assert [e.number for e in robot.event_log if e.number in (10005, 10008)] == [10005, 10008]


def test_a_program_that_stops_itself_is_not_gone_on_with_from_main(make):
    robot = make(
        "count:=count+1; IF kept=1 THEN kept:=2; Stop; ENDIF", lambda r: (r.panel.pointer_to_main(), start(r))
    )
    robot.run()
    assert robot.program.read("count") == 1.0


def test_pointer_to_main_and_loading_anew(make):
    orders = []

    def operator(robot):
        if not orders:
            robot.panel.reload_modules()
            robot.panel.start()
        orders.append(1)

    robot = make(operator=operator)
    robot.panel.at(2.0, robot.panel.stop)
    robot.run()
    assert (robot.program.read("count"), robot.program.read("kept")) == (10.0, 2.0)
    # The second start was from where the first one had come to.
    assert along(robot)[-1][1] == pytest.approx(600.0 + 191.0, abs=5.0)


def test_an_error_asks_for_the_pointer(make):
    def operator(robot):
        if robot.panel.state.pointer_lost:
            with pytest.raises(OrderRefusedError, match="pointer is lost"):
                robot.panel.start()
            robot.program.write("kept", "0")
            robot.panel.pointer_to_main()
        robot.panel.start()

    robot = make('IF kept=1 THEN kept:=1/(count-count); ENDIF TPWrite "over";', operator=operator)
    robot.run()
    assert robot.pendant_lines == ["over"]
    assert "ERR_DIVZERO" in robot.event_log[0].text
    with pytest.raises(RapidRuntimeError):  # nobody stands at the pendant
        make("kept:=1/(count-count);").run()


# Event routines

EVENTS = {"STOP": ("Stopped",), "QSTOP": ("Quick",), "RESTART": ("Restarted",), "START": ("Started",)}
ROUTINES = "\n".join(
    f'PROC {name}() TPWrite "{name}"; ENDPROC'
    for name in ("Stopped", "Quick", "Restarted", "Started", "Powered")
)


@pytest.mark.parametrize(
    ("order", "lines"),
    [
        (lambda p: p.stop(), ["Started", "Stopped", "Restarted", "there"]),
        (lambda p: p.emergency_stop(0), ["Started", "Quick", "Restarted", "there"]),
        (lambda p: p.open_guard(), ["Started", "Quick", "Restarted", "there"]),
        (lambda p: p.fail_power(), ["Started", "Powered", "Restarted", "there"]),
    ],
)
def test_event_routines_come_at_their_events(make, order, lines):
    robot = make(operator=recover, rest=ROUTINES)
    robot.execution.event_routines = {**EVENTS, "POWERON": ("Powered",)}
    robot.panel.at(2.0, lambda: order(robot.panel))
    robot.run()
    assert robot.pendant_lines == lines


@pytest.mark.parametrize(
    ("when", "lines"),
    [
        # The event came and its trap is still to come: the stop forgets it.
        ("before", ["Restarted", "over", "there"]),
        # It came while the program stood.
        ("standing", ["Restarted", "over", "there"]),
        # The event routine of the start itself: after it, for in it ExitCycle would end that routine alone.
        ("restart", ["Restarted", "over", "trap"]),
    ],
)
def test_a_stop_forgets_interrupts_and_what_a_restart_does_comes_after_it(make, when, lines):
    """RAPID overview, 3HAC050947-001, Interrupts: a stop empties the queue."""
    traps = f"""VAR intnum watched;
TRAP OnSpindle TPWrite "trap"; StopMove; ClearPath; StartMove; ExitCycle; ENDTRAP
PROC Watch() IF kept=1 THEN CONNECT watched WITH OnSpindle; ISignalDO doWanted,1,watched; ENDIF ENDPROC
PROC Restarted() TPWrite "Restarted"; {"SetDO doWanted,1;" if when == "restart" else ""}
WaitTime 0.5; TPWrite "over"; ENDPROC"""
    body = BODY.replace("kept:=kept+1;", "IF kept=2 THEN EXIT; ENDIF Watch; kept:=2;")

    def operator(robot):
        if when == "standing":
            robot.cell.write("doWanted", 1.0, 3.1)
        start(robot)

    robot = make(body, operator=operator, rest=traps)
    robot.execution.event_routines = {"RESTART": ("Restarted",)}
    if when == "before":
        robot.panel.at(3.0, lambda: robot.cell.write("doWanted", 1.0, 3.0))
    robot.panel.at(3.05, robot.panel.stop)
    robot.execution.keeps_on = False
    robot.run(cycles=2)
    assert robot.pendant_lines == lines


def test_an_event_routine_neither_moves_the_robot_nor_takes_its_time(make):
    rest = 'PROC Move() MoveL Offs(a,0,0,50),v100,fine,tMill; ENDPROC PROC Wait() WaitTime 60; TPWrite "w"; ENDPROC'
    robot = make(operator=start, rest=rest)
    robot.execution.event_routines = {"STOP": ("Move", "Wait")}
    robot.panel.at(2.0, robot.panel.stop)
    robot.run()
    texts = [e.text for e in robot.event_log if e.title == "event routine"]
    assert len(texts) == 2
    assert "a motion in an event routine" in texts[0]
    assert "more than 10 s" in texts[1]
    assert off_line(robot) < 1e-2
    assert robot.pendant_lines == ["there"]


def test_a_system_output_that_is_not_simulated_is_refused(tmp_path):
    (tmp_path / "EIO.cfg").write_text('SYSSIG_OUT:\n -Status "Lunch" -Signal "a"\n')
    with pytest.raises(SignalError, match="Lunch"):
        read_system_outputs(tmp_path / "EIO.cfg")
    (tmp_path / "EIO.cfg").write_text('EIO_CROSS:\n -Res "a" -Act1 "b" -Act2 "c"\n')
    with pytest.raises(SignalError, match="lacks"):
        read_system_outputs(tmp_path / "EIO.cfg")


# Outputs


def test_a_cross_connection_follows_the_running_program_and_power_takes_every_output(make):
    seen = []

    def operator(robot):
        seen.append([robot.cell.read(n) for n in ("doWanted", "doRun", "doSafe")])
        if len(seen) == 5:
            robot.panel.restore_power()
        if len(seen) == 10:
            recover(robot)

    body = "Set doWanted; Set doSafe;" + BODY
    robot = make(body, operator=operator)
    robot.panel.at(2.0, robot.panel.stop)
    robot.panel.at(2.08, robot.panel.fail_power)
    robot.run()
    assert seen[0] == [1.0, 0.0, 1.0] or seen[0] == [0.0, 0.0, 0.0]
    assert [0.0, 0.0, 0.0] in seen
    assert seen[-1] == [1.0, 0.0, 0.0]  # the safe one stays low, the other one has its value again
    assert robot.cell.read("doRun") == 0.0  # the program has ended


# Speed


def test_override_and_manual_mode_slow_the_tool_down(make):
    def largest(robot, since=0.0) -> float:
        path = robot.executed_path()
        step = np.linalg.norm(np.diff(path.T_base_tool_commanded[:, :3, 3], axis=0), axis=1)
        late = path.time[:-1] > since
        return float((step[late] / np.maximum(np.diff(path.time), 1e-6)[late]).max())

    robot = make()
    robot.panel.set_speed_override(25.0)
    robot.run()
    assert largest(robot) == pytest.approx(0.025, rel=1e-3)
    robot = make()
    robot.panel.at(2.0, lambda: robot.panel.set_speed_override(10.0))
    robot.run()
    assert largest(robot) == pytest.approx(0.1, rel=1e-3)
    assert largest(robot, since=2.1) == pytest.approx(0.01, rel=1e-3)
    robot = make(BODY.replace("v100", "v1000"))
    robot.panel.set_mode(OperatingMode.MANUAL_REDUCED)
    robot.panel.motors(True)
    robot.run()
    assert largest(robot) == pytest.approx(0.25, rel=1e-3)


def test_an_override_of_0_holds_the_robot(make):
    robot = make()
    robot.panel.at(2.0, lambda: robot.panel.set_speed_override(0.0))
    robot.panel.at(30.0, lambda: robot.panel.set_speed_override(100.0))
    robot.run()
    assert 34.0 < robot.now() < 34.5
    assert along(robot)[-1][1] == pytest.approx(600.0, abs=1e-3)


# What the panel refuses


def test_orders_out_of_place_are_refused(make):
    robot = make()
    panel = robot.panel
    with pytest.raises(OrderRefusedError, match="0 to 100"):
        panel.set_speed_override(101.0)
    panel.emergency_stop()
    for order in (panel.start, lambda: panel.motors(True), robot.run):
        with pytest.raises(OrderRefusedError, match="emergencystop"):
            order()
    panel.release_emergency_stop()
    assert panel.state.controller is ControllerState.EMERGENCY_STOP_RESET
    panel.motors(True)
    panel.open_guard()
    with pytest.raises(OrderRefusedError, match="guardstop"):
        panel.motors(True)
    panel.set_mode(OperatingMode.MANUAL_REDUCED)
    panel.motors(True)  # the guard is not seen in manual mode
    assert panel.motors_on
    panel.set_mode(OperatingMode.AUTO)
    assert panel.state.controller is ControllerState.GUARD_STOP
    refused = []
    other = make()

    def meddle(_robot):
        for order in (other.panel.pointer_to_main, other.panel.reload_modules, other.panel.start):
            try:
                order()
            except OrderRefusedError as error:
                refused.append(error.message)

    other.panel.at(1.0, lambda: meddle(other))
    other.run()
    assert len(refused) == 3
    assert all("the program runs" in text for text in refused)


# Rules for motions


SHORT = "a:=CRobT(\\Tool:=tMill); ConfL\\Off; FOR i FROM 1 TO 9 DO MoveL Offs(a,0,i,0),v200,z0,tMill; ENDFOR"


def test_closely_spaced_positions_are_slow_and_many_of_them_stop_the_program(make):
    """1 mm at 200 mm/s is 5 ms; nine of them take 24 ms each at least, and the fourth is refused."""
    slow = make(SHORT, limits=ControllerLimits(short_in_row=None))
    slow.run()
    assert slow.now() > 9 * 0.024
    robot = make(SHORT, limits=ControllerLimits())
    with pytest.raises(RapidMotionError, match=r"4 motions in a row below 24 ms.*closely spaced"):
        robot.run()
    assert [e.number for e in robot.event_log if e.kind == "error"] == [50078]


def test_a_motion_of_no_length_with_a_zone_is_a_corner_path_failure(make):
    body = BODY.replace('TPWrite "there";', "MoveL Offs(a,0,600,0),v100,z1,tMill;")
    robot = make(body, limits=ControllerLimits(short_in_row=None))
    robot.run()
    assert [e.number for e in robot.event_log if e.kind == "warning"] == [50024]
    lenient = make(body, limits=ControllerLimits(short_in_row=None, zero_length=False))
    lenient.run()
    assert not lenient.event_log


def test_an_axis_near_a_border_of_quadrants_counts_as_on_the_wrong_side(make):
    """Axis 1 stands at 0: a calibrated arm may stand at -0.1 degrees, where cf1 is -1."""
    near = "a:=CRobT(\\Tool:=tMill); ConfL\\On; MoveL Offs(a,50,0,0),v100,fine,tMill;"
    with pytest.raises(RapidMotionError, match=r"0\.5 deg within its quadrant") as caught:
        make(near, limits=ControllerLimits()).run()
    assert caught.value.data["line"] > 0
    make(near, limits=ControllerLimits(quadrant_margin=0.0)).run()


def test_a_joint_motion_to_a_target_near_a_border_of_quadrants_may_go_to_the_wrong_side(make):
    """Under ConfJ the target's configuration is taken at its word, whichever the calibrated arm has there."""
    near = "a:=CRobT(\\Tool:=tMill); ConfJ\\On; MoveJ Offs(a,50,0,0),v100,fine,tMill;"
    with pytest.raises(RapidMotionError, match=r"0\.5 deg within its quadrant"):
        make(near, limits=ControllerLimits()).run()
    make(near, limits=ControllerLimits(quadrant_margin=0.0)).run()
    make(near.replace("\\On", "\\Off"), limits=ControllerLimits()).run()
