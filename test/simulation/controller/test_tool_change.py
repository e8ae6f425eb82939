"""Doors of two tools on the project's own modules: changed at the rack, refused where something is wrong with it."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.checksum import checksum
from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.simulation.controller.cabinet.cell import DOOR_CLAMPED
from doormill_ros.simulation.controller.records.process import module_process
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.program import RACK_KINDS, MotionKind
from support.judged_doors import rigid
from support.two_tools import two_tool_door

HOME = [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]
OTHER_TOOL = ("Another tool is in the spindle.", "Put tool 1 in, the others into the rack.")
LENGTH = ("Tool 1: measure from the spindle's nose.", "How far does it stand out [mm]?")


@pytest.fixture(scope="module")
def made():
    """The recipe, where its door stands, and what was planned for a robot that does not give way."""
    setup, recipe = rigid(load_setup()), two_tool_door()
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    return recipe, T_base_door, plan(recipe, T_base_door, setup)


@pytest.fixture
def started(made, controller):
    """A controller with the door's file, at which somebody presses the first button of every question."""

    def started_(text=None, **kwargs):
        program = made[2].program
        robot = controller(process=module_process(program), **kwargs)
        data = render_target_file(program, "run-1") if text is None else text
        (robot.home / signals.TARGET_FILE).write_bytes(data)
        robot.teach_pendant.operator = lambda dialog: dialog.buttons[0][0]
        return robot

    return started_


def cuts(robot):
    return [context.index for context in robot.recording.context if context.cutting]


def test_a_door_of_two_tools_is_milled_and_nothing_is_touched(made, started):
    recipe, T_base_door, planned = made
    robot = started()
    robot.run()
    assert robot.pendant_lines[-1] == "Door is milled."
    executed = robot.executed_path()
    verdict = judge(recipe, T_base_door, executed, load_cell(), robot.spindle_turned(executed.time))
    assert verdict.error is None, verdict.sentence
    assert inspect(recipe, T_base_door, executed).max_deviation < 1e-4
    for feature in recipe.features:
        assert set(executed.tool[executed.feature == feature.id]) == {feature.tool.name}
    assert "" in executed.tool  # on the way from one place to the other
    assert robot.cell.rack.harm == []
    assert (robot.cell.rack.carried, robot.program.read("toolPlace")) == ("rack_mill_16", 1.0)
    assert not executed.spindle_on[executed.tool == ""].any()
    assert executed.time[-1] == pytest.approx(planned.time, rel=0.05)


def test_the_judge_goes_by_the_tool_that_is_carried(made, started):
    """Somebody has put the tools into each other's places: the file is the same, the wood is not."""
    recipe, T_base_door, _ = made
    robot = started()
    rack = robot.cell.rack
    rack.carried, rack.standing = "rack_mill_12", ["", "rack_mill_16"]
    robot.run()
    executed = robot.executed_path()
    verdict = judge(recipe, T_base_door, executed, load_cell(), robot.spindle_turned(executed.time))
    assert verdict.volume > 1e-6
    assert {gone.feature for gone in verdict.gone} == {"hinge_1"}
    assert inspect(recipe, T_base_door, executed).feature("hinge_1").max_deviation == pytest.approx(
        2e-3, abs=1e-4
    )


def no_tool(rack):
    rack.faults.missing.add("rack_mill_12")


def stuck(rack):
    rack.faults.drawbar_opens = False


def loose(rack):
    rack.faults.drawbar_holds = False


def stuck_gauge(rack):
    rack.faults.gauge_stuck = 10.0


def stands_out(further):
    return lambda rack: rack.faults.longer.update(rack_mill_12=further)


@pytest.mark.parametrize(
    ("fault", "reason", "by_hand"),
    [
        (no_tool, "No tool is clamped from place:\n2", True),
        (loose, "No tool is clamped from place:\n2", True),
        (stuck, "The drawbar does not open or close.", True),
        (stuck_gauge, "Nothing presses the gauge, yet it reads [mm]:\n10", False),
        (
            stands_out(0.9e-3),
            "The tool has another length [mm]:\n120.9",
            False,
        ),
        (
            stands_out(-0.9e-3),
            "The tool has another length [mm]:\n119.1",
            False,
        ),
    ],
    ids=["missing", "not clamped", "drawbar", "gauge", "too long", "too short"],
)
def test_what_is_wrong_at_the_rack_ends_the_door_before_the_next_cut(made, started, fault, reason, by_hand):
    robot = started()
    fault(robot.cell.rack)
    robot.run()
    told = (robot.home / signals.REFUSED_FILE).read_text()
    assert told.startswith(f"1\n{reason}")
    first_rack_work = next(i for i, m in enumerate(made[2].program.motions) if m.kind in RACK_KINDS)
    assert max(cuts(robot)) < first_rack_work
    assert robot.io.read("doPathFault") == 1
    assert [robot.read_signal(name) for name in ("doSpindleOn", "doDrawbarOpen")] == [0.0, 0.0]
    assert robot.program.read("escapeKnown") is not by_hand
    robot.cell.rack.faults.drawbar_opens = True
    led_home(robot, by_hand)


def led_home(robot, by_hand):
    """Somebody jogs the robot out and home, and puts the tools back, as the pendant asks for."""
    asked = []

    def operator(dialog):
        asked.append(dialog.lines)
        if by_hand and "Jog it" in dialog.lines[1]:
            jog_home(robot)
        if dialog.lines == OTHER_TOOL:
            robot.cell.rack.hold(0)
            robot.cell.show_drawbar()
        return "120" if dialog.lines == LENGTH else dialog.buttons[0][0]

    robot.teach_pendant.operator = operator
    robot._on_time = lambda c: (
        c.program.read("toolPlace") == 1.0
        and c.program.read("toolMeasured")
        and not c.program.read("doorInHand")
        and c.stop()
    )
    with pytest.raises(Exception, match="stopped from outside"):
        robot.run(reset=False)
    second = [lines[1] for lines in asked]
    assert second[0] == ("Jog it clear of the door and run MoveHome." if by_hand else "Retract and go home?")
    assert np.allclose(np.degrees(robot.q), HOME, atol=1e-3)
    assert robot.program.read("toolMill")[1][0][2] == 250.0
    assert asked[-2:] == [OTHER_TOOL, LENGTH]
    if robot.cell.rack.carried != "":
        assert robot.cell.rack.carried == "rack_mill_16"


def test_a_gauge_that_stays_pressed_measures_no_tool(started):
    """It read right once, with this tool."""
    robot = started()

    def stick(c):
        if c.read_signal("aiToolGauge") > 9.99:
            c.cell.rack.faults.gauge_stuck = 10.0

    robot._on_time = stick
    robot.run()
    assert (robot.home / signals.REFUSED_FILE).read_text().startswith("1\nNothing presses the gauge")
    assert robot.program.read("toolMeasured") is False
    led_home(robot, by_hand=False)


def test_a_spindle_without_a_brake_is_waited_for(started):
    robot = started(patience=None)
    robot.cell.coasting_time = 60.0
    robot.run()
    assert robot.pendant_lines[-1] == "Door is milled."
    assert robot.teach_pendant.dialogs == []
    assert robot.cell.rack.harm == []


def jog_home(robot):
    robot._engine.q = np.radians(HOME)
    robot._engine.planned_q = np.radians(HOME)


def test_a_tool_that_stands_out_a_little_further_mills_as_deep(made, started):
    recipe, T_base_door, _ = made
    robot = started()
    robot.cell.rack.faults.longer["rack_mill_12"] = 0.3e-3
    robot.run()
    assert robot.pendant_lines[-1] == "Door is milled."
    hinge = inspect(recipe, T_base_door, robot.executed_path()).feature("hinge_1")
    assert np.abs(hinge.floor).max() < 5e-5
    assert robot.program.read("toolMill")[1][0][2] == pytest.approx(250.0, abs=1e-3)  # the first tool's again


def put_in(robot, *tries):
    """Somebody puts tool 1 in once for each pair of what it stands out further [mm] and what he then types."""
    asked, left = [], list(tries)

    def operator(dialog):
        asked.append(dialog.lines)
        if dialog.lines == OTHER_TOOL:
            robot.cell.rack.faults.longer["rack_mill_16"] = left[0][0] * 1e-3
        return left.pop(0)[1] if dialog.lines == LENGTH else dialog.buttons[0][0]

    robot.program.write("toolPlace", "-1")
    robot.teach_pendant.operator = operator
    robot.run()
    assert not left
    assert robot.pendant_lines[-1] == "Door is milled."
    return asked


def lock_case_floor(made, robot):
    recipe, T_base_door, _ = made
    return inspect(recipe, T_base_door, robot.executed_path()).feature("lock_case").floor


@pytest.mark.parametrize("longer", [-0.3, 0.0, 0.3])
def test_a_tool_that_was_put_in_by_hand_mills_as_deep_as_it_was_measured_for(made, started, longer):
    robot = started()
    assert put_in(robot, (longer, f"{120 + longer}")) == [OTHER_TOOL, LENGTH]
    assert np.abs(lock_case_floor(made, robot)).max() < 5e-5


@pytest.mark.parametrize("typed", ["123", "117", "OK", "120.51", "-120"])
def test_a_tool_of_another_length_that_was_put_in_by_hand_is_asked_for_again(made, started, typed):
    robot = started()
    assert put_in(robot, (3.0, typed), (0.1, "120.1")) == [OTHER_TOOL, LENGTH] * 2
    length = "0" if typed == "OK" else typed
    told = robot.pendant_lines.index("The tool has another length [mm]:")
    assert float(robot.pendant_lines[told + 1]) == float(length)
    assert np.abs(lock_case_floor(made, robot)).max() < 5e-5


def test_a_tool_that_falls_while_it_is_measured_is_asked_for_again(made, started):
    robot = started()
    fallen = []

    def operator(dialog):
        if dialog.lines == LENGTH:
            fallen.append(not fallen)
            robot.cell.rack.hold(None if fallen[-1] else 0)
            robot.cell.show_drawbar()
            return "120"
        if dialog.lines == OTHER_TOOL:
            robot.cell.rack.hold(0)
            robot.cell.show_drawbar()
        return dialog.buttons[0][0]

    robot.program.write("toolPlace", "-1")
    robot.teach_pendant.operator = operator
    robot.run()
    assert fallen == [True, False]
    assert [dialog.lines for dialog in robot.teach_pendant.dialogs] == [OTHER_TOOL, LENGTH] * 2


def test_the_first_tool_that_the_gauge_refuses_is_no_measured_one(started):
    robot = started()
    robot.cell.rack.faults.longer["rack_mill_16"] = 0.9e-3
    robot.run()
    assert (robot.home / signals.REFUSED_FILE).read_text().startswith("1\nThe tool has another length [mm]:")
    led_home(robot, by_hand=False)


def test_the_first_tool_that_was_taken_and_not_measured_is_measured_by_hand(started):
    """The door is taken out of the clamp while the robot goes from the place to the gauge."""
    robot = started()
    changed = []

    def watch(c):
        place = c.program.read("toolPlace")
        if place == 2.0 and not changed:
            changed.append(place)
        if changed == [2.0] and place == 1.0 and not c.program.read("atRack"):
            changed.append(place)
            c.cell.set_input(DOOR_CLAMPED, 0.0)

    robot._on_time = watch
    robot.run()
    assert robot.program.read("toolPlace") == 1.0
    asked = []

    def operator(dialog):
        asked.append(dialog.lines)
        return "120.2" if dialog.lines == LENGTH else dialog.buttons[0][0]

    robot.teach_pendant.operator = operator
    robot._on_time = lambda c: (
        c.program.read("toolMeasured") and not c.program.read("doorInHand") and c.stop()
    )
    with pytest.raises(Exception, match="stopped from outside"):
        robot.run(reset=False)
    assert asked[-1] == LENGTH
    assert OTHER_TOOL not in asked
    assert robot.program.read("toolMill")[1][0][2] == pytest.approx(250.2, abs=1e-3)


@pytest.mark.parametrize("what", ["stop", "fail_power"])
def test_a_stop_at_the_rack_is_not_gone_on_from(started, what):
    done = []

    def watch(c):
        if not done and c.program.read("atRack") and c.read_signal("doDrawbarOpen") == 1.0:
            done.append(c.now())
            getattr(c.panel, what)()

    def operator(c):
        state = c.panel.state
        if not state.powered:
            c.panel.restore_power()
        if not c.panel.motors_on:
            c.panel.motors(True)
        if not c.panel.running:
            c.panel.start()

    robot = started(on_stopped=operator)
    robot._on_time = watch
    robot.run()
    assert done
    assert robot.read_signal("doDrawbarOpen") == 0.0
    assert robot.program.read("stopReason") != 0.0
    assert robot.program.read("escapeKnown") is False
    led_home(robot, by_hand=True)


def changed(data, wrong):
    """The file with other motions and the right checksum."""
    lines = [wrong(line) for line in data.decode().splitlines()[:-1]]
    a, b = checksum(lines)
    return "".join(f"{line}\n" for line in [*lines, f"#sum [{a},{b}]"]).encode()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('#move ["T",', '#move ["P",'),  # puts a tool away twice
        (',2,1000,"fine"', ',1,1000,"fine"'),  # another place than the one in front of which the point is
        ('#move ["M",', '#move ["A",'),  # mills without measuring
    ],
)
def test_a_file_whose_changes_do_not_fit_is_refused(made, started, old, new):
    def wrong(line):
        text = line.replace(old, new) if line.startswith("#move") else line
        return (
            text
            if not text.startswith('#move ["A"')
            else text.split(",")[0] + "," + text.split(",")[1] + ",0," + (",".join(text.split(",")[3:]))
        )

    data = changed(render_target_file(made[2].program, "run-1"), wrong)
    robot = started(data)
    robot.run()
    assert robot.pendant_lines[-2] == "The tool changes do not fit this rack."
    assert not cuts(robot)


def test_the_file_says_the_changes_again(made):
    program = made[2].program
    read = read_target_file(render_target_file(program, "run-1"))
    assert [(m.kind, m.target, m.via) for m in read.motions] == [
        (m.kind, m.target, m.via) for m in program.motions
    ]
    kinds = [m.kind for m in read.motions if m.kind in RACK_KINDS]
    assert kinds == [MotionKind.PUT, MotionKind.TAKE, MotionKind.MEASURE] * 2


def test_pc_and_controller_have_the_same_rack(controller):
    rack, read = load_setup().layout.rack, controller().program.read
    fronts = np.array([joints for joints, _ in read("rackFronts")])
    assert read("RACK_PLACES") == len(rack.places)
    assert np.allclose(
        np.degrees([place.front for place in rack.places]), fronts[: len(rack.places)], atol=1e-4
    )
    assert np.allclose(np.degrees(rack.gauge.front), read("gaugeFront")[0], atol=1e-4)
    assert (read("RACK_DEPTH"), read("GAUGE_DEPTH")) == pytest.approx(
        (1e3 * rack.depth, 1e3 * rack.gauge.depth)
    )
    settings, layout = load_setup().settings, load_setup().layout
    assert read("NOSE") == pytest.approx(1e3 * (layout.T_flange_tool[2, 3] - settings.approach.nose))
    assert read("LENGTH_LIMIT") == pytest.approx(1e3 * settings.checks.tool_length)
