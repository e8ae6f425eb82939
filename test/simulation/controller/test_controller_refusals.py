"""What our module refuses to mill, and what it says on the pendant."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from doormill_ros.abb import signals
from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.target_file.checksum import checksum
from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.resources import resource
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES, read_installed
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from support.rapid_bench import answer, reading_modules, run_of

PC_WRITES = (*signals.PC_SIGNALS, *signals.GROUP_SIGNALS)


@pytest.fixture
def good(door) -> bytes:
    return render_target_file(door("thesis_190_0deg"), "run-1")


def signed(lines: list[str]) -> bytes:
    """A file of these lines whose checksum is right."""
    a, b = checksum(lines)
    return ("\n".join([*lines, f"#sum [{a},{b}]"]) + "\n").encode()


def lines_of(data: bytes) -> list[str]:
    """The lines without the checksum."""
    return data.decode().splitlines()[:-1]


def put(controller, data: bytes | None) -> None:
    path = controller.home / "Hei2.txt"
    path.unlink(missing_ok=True)
    if data is not None:
        path.write_bytes(data)


def assert_refused(controller, *words: str) -> None:
    """Refused: told on the pendant, fault high, request and busy low, and nothing moved."""
    assert controller.moves == []
    assert controller.executed_count == 0
    history = controller.io.history
    assert ("doPathBusy", 1) not in history
    assert history.index(("doPathFault", 1)) < history.index(("doPathRequest", 0))
    assert [controller.io.read(s) for s in ("doPathRequest", "doPathFault", "doPathBusy", "doPathDone")] == [
        0,
        1,
        0,
        0,
    ]
    for word in words:
        assert word in " ".join(controller.pendant_lines), controller.pendant_lines
        assert word in " ".join(entry.text for entry in controller.event_log)
    assert max(map(len, controller.pendant_lines)) <= 80


def test_a_good_file_is_milled_and_acknowledged_in_order(good, controller):
    robot = controller(expected_door="thesis_190_0deg")
    put(robot, good)
    robot.run()
    controller_side = [change for change in robot.io.history if change[0] not in PC_WRITES]
    assert controller_side == [
        ("doPathRequest", 1),
        ("doPathBusy", 1),
        ("doPathRequest", 0),
        ("doPathDone", 1),
        ("doPathBusy", 0),
    ]
    assert robot.pendant_lines == ["Milling door:", "thesis_190_0deg", "Door is milled."]
    assert robot.program.read("seenRuns")[0] == "run-1"
    assert (robot.home / signals.MILLED_FILE).read_text() == "run-1\n"
    assert robot.read_signal("doSpindleOn") == robot.read_signal("doBlowOff") == 0.0
    assert np.allclose(np.degrees(robot.q), [0, -40, 30, 0, 10, 0], atol=1e-4)


def test_a_missing_file(controller):
    robot = controller()
    put(robot, None)
    robot.run()
    assert_refused(robot, "missing")


def test_an_empty_file(controller):
    robot = controller()
    put(robot, b"")
    robot.run()
    assert_refused(robot, "cut short", "Line 1")


def test_another_door(good, controller):
    robot = controller(expected_door="other_door")
    put(robot, good)
    robot.run()
    assert_refused(robot, "another door", "thesis_190_0deg")


def test_no_path_is_asked_for_before_the_door_has_a_name(good, controller):
    robot = controller(expected_door="", patience=None)
    put(robot, good)
    robot._on_time = lambda c: c.now() > 5.0 and c.stop()
    with pytest.raises(RapidStoppedError):
        robot.run()
    assert robot.pendant_lines == ["Waiting for the name of the door."]
    assert robot.io.history == []
    assert robot.moves == []


def test_a_file_is_refused_when_its_order_is_missing(good, controller):
    robot = controller(on_wait=lambda c: announce(c, order=None))
    put(robot, good)
    robot.run()
    assert_refused(robot, "No order was announced.", "run-1")


def announce(controller, order: str | None) -> None:
    """Ready for the present request, whatever the order file says."""
    request = int(controller.program.read("requestNumber"))
    if order is not None:
        (controller.home / signals.ORDER_FILE).write_text(order)
    controller.io.write(signals.READY_NUMBER, request if controller.io.read(signals.REQUEST) else 0)


def test_a_pc_that_announces_no_order_is_an_explicit_choice(good, controller, tmp_path):
    """ORDER_REQUIRED is a constant of the cell's own module: doPathReady alone is then believed."""
    modules = [resource(name) for name in OWN_MODULES if not name.endswith("DoorCell.mod")]
    changed = tmp_path / "DoorCell.mod"
    text = resource("rapid/DoorCell.mod").read_text()
    assert text.count("CONST bool ORDER_REQUIRED:=TRUE;") == 1
    changed.write_text(text.replace("ORDER_REQUIRED:=TRUE", "ORDER_REQUIRED:=FALSE"))

    def level_only(robot):
        robot.io.write(signals.READY, robot.io.read(signals.REQUEST))
        robot.cell.set_input("diDoorClamped", float(not robot.io.read(signals.DONE)))

    robot = controller(modules=[*modules, changed], on_wait=level_only)
    put(robot, good)
    robot.run()
    assert robot.io.read(signals.DONE) == 1


def test_a_run_is_milled_once(good, controller):
    robot = controller()
    put(robot, good)
    robot.run()
    before = len(robot.moves)
    robot.io.history.clear()
    robot.run()
    assert len(robot.moves) == before
    assert robot.pendant_lines[-2:] == ["This run was milled before:", "run-1"]
    assert ("doPathBusy", 1) not in robot.io.history


def test_seventeen_runs_are_told_apart_and_the_last_sixteen_remembered(door, controller, tmp_path):
    robot = controller(modules=reading_modules(tmp_path))
    for number in range(17):
        put(robot, render_target_file(door("thesis_190_0deg"), f"run-{number}"))
        robot.program.run("ReadAndTell")
        robot.program.run("RememberRun", reset=False)
    last = [f"run-{n}" for n in range(1, 17)]
    assert sorted(robot.program.read("seenRuns")) == sorted(last)
    # They outlive the module: the oldest comes first in the file, and is the next to be forgotten.
    assert (robot.home / "Hei2.old").read_text().splitlines() == last
    anew = controller()
    anew.program.run("RecallRuns")
    assert anew.program.read("seenRuns") == last
    assert anew.program.read("seenNext") == 1


def test_the_number_of_the_request_outlives_the_module(good, controller):
    robot = controller()
    put(robot, good)
    robot.run()
    anew = controller(commissioned=False)
    anew.program.run("RecallRuns")
    assert anew.program.read("requestNumber") == 1
    assert "run-1" in anew.program.read("seenRuns")


def test_a_spent_run_stays_spent_when_milling_was_broken_off(good, controller):
    robot = controller(patience=None)
    robot.cell.spindle_works = False
    put(robot, good)
    robot.run()
    robot.teach_pendant.operator = lambda _: "OK"
    assert robot.io.read("doPathFault") == 1
    assert robot.read_signal("doSpindleOn") == 0.0
    robot.cell.spindle_works = True
    # The door is taken out, and another one comes with the same file.
    robot.run()
    assert "The spindle does not reach its speed." in robot.pendant_lines
    robot.run()
    assert "This run was milled before:" in robot.pendant_lines
    assert robot.moves == []


def test_every_cut_through_the_file_is_refused(good, controller):
    """A file cut after any byte: at each line end, and at some places within lines."""
    robot = controller()
    ends = [i + 1 for i, byte in enumerate(good[:-1]) if byte == 0x0A]
    within = list(range(1, len(good) - 1, 97))
    for length in ends + within:
        put(robot, good[:length])
        robot.io.history.clear()
        robot.run()
        assert ("doPathBusy", 1) not in robot.io.history, length
    assert robot.moves == []
    # The line feed after the checksum may be missing on the wire; nothing else is missing then.
    with pytest.raises(AbbError):
        read_target_file(good[:-1])


def test_the_file_is_read_whole_where_nothing_is_changed(good, checker):
    assert checker(good)


@settings(max_examples=60)
@given(data=st.data())
def test_no_changed_byte_is_milled(data, good, checker):
    at = data.draw(st.integers(0, len(good) - 2))
    byte = data.draw(st.integers(0, 255).filter(lambda value: value != good[at]))
    assert not checker(good[:at] + bytes([byte]) + good[at + 1 :])


@settings(max_examples=60)
@given(data=st.data())
def test_no_lost_doubled_or_exchanged_line_is_milled(data, good, checker):
    lines = good.decode().splitlines()
    kind = data.draw(st.sampled_from(["lose", "double", "exchange"]))
    i, j = (data.draw(st.integers(0, len(lines) - 1)) for _ in range(2))
    changed = list(lines)
    if kind == "lose":
        del changed[i]
    elif kind == "double":
        changed.insert(j, lines[i])
    else:
        changed[i], changed[j] = lines[j], lines[i]
    assume(changed != lines)
    assert not checker(("\n".join(changed) + "\n").encode())


@pytest.fixture(scope="module")
def checker(tmp_path_factory, arm):
    """Whether the module's reading accepts a file; the Python reader must agree."""
    from doormill_ros.simulation.controller.controller import VirtualController

    home = tmp_path_factory.mktemp("home")
    robot = VirtualController(home, arm, installed=read_installed(reading_modules(home)))
    probe = robot.program

    def accepts(data: bytes) -> bool:
        (robot.home / "Hei2.txt").write_bytes(data)
        (robot.home / "Hei2.run").write_text(f"{run_of(robot.home)}\n0\n")
        # An error that stops the program at a string function would be raised here.
        probe.run("ReadAndTell")
        in_rapid = probe.read("accepted")
        try:
            read_target_file(data)
            in_python = True
        except AbbError:
            in_python = False
        assert in_rapid or probe.read("refusal") > 0
        assert in_rapid == in_python or (in_rapid and not in_python and not data.endswith(b"\n"))
        return in_rapid

    return accepts


REPLACED = {
    "a quaternion that is not unit": (
        r"0.7071068;0.0000000;0.7071068",
        "0.7071068;0.0000000;0.8071068",
        "not unit",
    ),
    "a comma for a point": ("1845.000", "1845,000", "something else than numbers"),
    "a letter": ("1845.000", "184O.000", "something else than numbers"),
    "an empty field": ("259.5000;", ";", "fewer than 11"),
    "a twelfth number": ("0;0;0;1;", "0;0;0;1;0;", "more than 11"),
    "a configuration out of range": ("0;0;0;1;", "0;0;0;8;", "out of range"),
    "half a quarter turn": ("0;0;0;1;", "0;0.5;0;1;", "out of range"),
    "another version": ("#doormill 2", "#doormill 3", "another version"),
    "a wrong number of targets": ("#targets 14", "#targets 13", "number of targets"),
    "a target that does not exist": ('["L",3,0,200', '["L",15,0,200', "out of range"),
    "a target between two": ('["L",3,0,200', '["L",3.5,0,200', "out of range"),
    "a circle point of a line": ('["L",3,0,200', '["L",3,2,200', "out of range"),
    "an arc without circle point": ('["C",4,2,50', '["C",4,0,50', "out of range"),
    "an unknown kind": ('["L",3,0,200', '["Q",3,0,200', "unknown kind"),
    "an unknown zone": ('200,"z0",1,FALSE', '200,"z9",1,FALSE', "Unknown zone"),
    "standing still": ('["L",3,0,200', '["L",3,0,0', "no permitted speed"),
    "too fast a motion": ('["L",3,0,200', '["L",3,0,7001', "no permitted speed"),
    "too fast a spindle": ("TRUE,3200", "TRUE,24001", "no permitted spindle"),
    "cutting at rest": ("TRUE,3200", "TRUE,0", "spindle at rest"),
    "a motion that cannot be read": ('["C",4,2,50', '["C",4,2,fast', "cannot be read"),
    "an arc first": ('["A",1,0,1000', '["C",1,2,1000', "none of the axes"),
    "too many features": ("#features 2", "#features 41", "out of range"),
    "a missing key": ("#recipe ", "#receipt ", "not what it should be"),
}


@pytest.mark.parametrize("what", REPLACED)
def test_a_wrong_content_is_refused_although_its_checksum_is_right(what, good, controller):
    found, put_instead, words = REPLACED[what]
    lines = lines_of(good)
    index = next(i for i, line in enumerate(lines) if found in line)
    lines[index] = lines[index].replace(found, put_instead, 1)
    robot = controller()
    put(robot, signed(lines))
    robot.run()
    assert_refused(robot, words, "Line ")
    if "spindle" not in words and "none of the axes" not in words:
        with pytest.raises(AbbError):
            read_target_file(signed(lines))


def test_what_follows_the_checksum_is_refused(good, controller):
    robot = controller()
    put(robot, good + b"1;2;3;1;0;0;0;0;0;0;0;\n")
    robot.run()
    assert_refused(robot, "after its checksum")


def test_more_targets_than_the_arrays_hold_are_refused(good, controller):
    lines = lines_of(good)
    robot = controller()
    put(robot, signed(lines[:1] * 2001 + lines[14:]))
    robot.run()
    assert_refused(robot, "Too many targets")


def test_the_robot_does_not_set_off_from_anywhere_but_home(good, controller):
    """Without a door in hand nothing is known of the way: the operator jogs and calls MoveHome."""
    robot = controller(start=np.radians([0.0, 0.0, 0.0, 0.0, 20.0, 0.0]))
    put(robot, good)
    asked = []

    def jog(dialog):
        asked.append(dialog)
        if len(asked) == 3:
            robot.program.context.machine.current_joints = lambda: [0.0, -40.0, 30.0, 0.0, 10.0, 0.0]
        return "OK"

    robot.teach_pendant.operator = jog
    robot.run()
    assert [d.lines for d in asked] == [
        ("The robot is not at home.", "Jog it clear of the door and run MoveHome.")
    ] * 3
    assert robot.io.read("doPathDone") == 1


def test_a_door_that_comes_loose_stops_the_robot_and_then_the_spindle(good, controller):
    robot = controller()
    put(robot, good)
    falls = []

    def loosen(c):
        if c.motion_count >= 5:
            c.cell.set_input("diDoorClamped", 0.0)
        if c.program.read("stopReason"):
            falls.append(c.moving)

    robot._on_time = loosen
    robot.run()
    assert robot.read_signal("doSpindleOn") == 0.0
    # Busy until the robot is home: nobody takes a door out in which the tool stands.
    assert [robot.io.read(s) for s in ("doPathFault", "doPathBusy", "doPathDone")] == [1, 1, 0]
    assert not robot.moving
    assert not any(falls)
    assert len(robot.moves) < 10
    assert (robot.home / "Hei2.err").read_text() == "1\nThe door was released while milling.\n"


@pytest.mark.parametrize("name", [signals.READY, signals.READY_NUMBER])
def test_ready_that_stays_high_from_before_is_not_taken_for_an_answer(good, controller, name):
    """It is waited for without end, and the pendant says for whom."""
    waits = []

    def late(c):
        waits.append(c.now())
        if c.now() > 100.0:
            c.io.write(name, 0)
            answer(c)

    robot = controller(on_wait=late, patience=None)
    put(robot, good)
    robot.io.write(name, 1)
    robot.run()
    assert waits[-1] > 100.0
    assert "Waiting for the PC." in robot.pendant_lines
    assert robot.io.read("doPathDone") == 1


def after(seconds, action):
    """The surroundings do nothing for so much simulated time, then what `action` does."""

    def wait(c):
        if c.now() > seconds:
            action(c)

    return wait


def test_a_pc_that_is_away_for_an_hour_does_not_stop_the_robot(good, controller):
    robot = controller(on_wait=after(3600.0, answer), patience=None)
    put(robot, good)
    robot.run()
    assert robot.now() > 3600.0
    assert robot.io.read("doPathDone") == 1
    assert robot.teach_pendant.dialogs == []


def test_no_door_for_an_hour_does_not_stop_the_robot(good, controller):
    def clamp(c):
        if not c.program.read("doorSpent") and not c.program.read("doorInHand"):
            c.cell.set_input("diDoorClamped", 1.0)
        answer(c)

    robot = controller(on_wait=after(3600.0, clamp), patience=None)
    put(robot, good)
    robot.clamped = 0.0
    robot.run()
    assert robot.now() > 3600.0
    assert robot.pendant_lines[0] == "Waiting for a door in the clamp."
    assert robot.io.read("doPathDone") == 1
    assert robot.teach_pendant.dialogs == []


def test_a_door_without_a_name_for_ten_minutes_does_not_stop_the_robot(good, controller):
    def name(c):
        if not c.program.read("doorSpent") and c.program.read("expectedDoor") == "":
            (c.home / "Hei2.exp").write_text(f"thesis_190_0deg\n{signals.EXPECTED_END}\n")
        answer(c)

    robot = controller(expected_door="", on_wait=after(600.0, name), patience=None)
    put(robot, good)
    robot.run()
    assert robot.now() > 600.0
    assert robot.io.read("doPathDone") == 1
    assert not (robot.home / "Hei2.exp").exists()


def test_a_door_that_is_taken_out_before_its_path_came_withdraws_the_request(controller):
    robot = controller(
        on_wait=lambda c: c.cell.set_input("diDoorClamped", float(c.io.read("doPathRequest") == 0))
    )
    robot.run()
    assert robot.io.history[-1] == ("doPathRequest", 0)
    assert ("doPathFault", 1) not in robot.io.history
    assert robot.pendant_lines[-1] == "The door was taken out before its path came."


def test_a_door_that_is_exchanged_while_its_file_is_read_is_not_milled(good, controller):
    """Of the same name, and quicker than the program looks at the clamp: only the interrupt sees it."""
    robot = controller()
    put(robot, good)
    done: list[str] = []
    opened = 0.0

    def exchange(c):
        nonlocal opened
        if not done and c.io.read("doPathRequest") and c.io.read(signals.READY_NUMBER):
            c.cell.set_input("diDoorClamped", 0.0)
            done.append("opened")
            opened = c.now()
        elif done == ["opened"] and c.now() > opened + 0.02:
            done.append("named" if c.program.read("expectedDoor") == "" else "still named")
            c.program.write("expectedDoor", '"thesis_190_0deg"')
            c.cell.set_input("diDoorClamped", 1.0)

    robot._on_time = exchange
    robot.run()
    assert done == ["opened", "named"]
    assert robot.moves == []
    assert ("doPathBusy", 1) not in robot.io.history
    assert robot.io.read("doPathRequest") == 0
