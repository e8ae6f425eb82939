"""What our module refuses to mill, and what it says on the pendant."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.target_file.checksum import checksum
from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError


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
    controller_side = [change for change in robot.io.history if change[0] != "doPathReady"]
    assert controller_side == [
        ("doPathRequest", 1),
        ("doPathBusy", 1),
        ("doPathRequest", 0),
        ("doPathBusy", 0),
        ("doPathDone", 1),
    ]
    assert robot.pendant_lines == ["Milling door:", "thesis_190_0deg", "Door is milled."]
    assert robot.program.read("seenRuns")[0] == "run-1"
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


def test_no_door_is_expected(good, controller):
    robot = controller(expected_door="")
    put(robot, good)
    robot.run()
    assert_refused(robot, "expectedDoor")


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


def test_seventeen_runs_are_told_apart_and_the_last_sixteen_remembered(door, controller):
    robot = controller()
    for number in range(17):
        put(robot, render_target_file(door("thesis_190_0deg"), f"run-{number}"))
        robot.program.run("ReadTargetFile")
        robot.program.run("RememberRun", reset=False)
    seen = robot.program.read("seenRuns")
    assert sorted(seen) == sorted(f"run-{n}" for n in range(1, 17))


def test_a_spent_run_stays_spent_when_milling_was_broken_off(good, controller):
    robot = controller(patience=None)
    robot.cell.spindle_works = False
    put(robot, good)
    robot.run()
    assert "A signal did not come in time." in robot.pendant_lines
    assert robot.io.read("doPathFault") == 1
    assert robot.read_signal("doSpindleOn") == 0.0
    robot.cell.spindle_works = True
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

    robot = VirtualController(tmp_path_factory.mktemp("home"), arm, expected_door="*")
    probe = robot.program

    def accepts(data: bytes) -> bool:
        (robot.home / "Hei2.txt").write_bytes(data)
        try:
            probe.run("ReadTargetFile")
            in_rapid, reason = True, "raised by the program"
        except RapidRuntimeError as error:
            in_rapid, reason = False, error.message
        try:
            read_target_file(data)
            in_python = True
        except AbbError:
            in_python = False
        # Refused in so many words: an error that stops the program at a string function would not do.
        assert "raised by the program" in reason
        assert in_rapid == in_python or (in_rapid and not in_python and not data.endswith(b"\n"))
        return in_rapid

    return accepts


REPLACED = {
    "a quaternion that is not unit": (
        r"0.7071068;0.0000000;0.7071068",
        "0.7071068;0.0000000;0.8071068",
        "not unit",
    ),
    "a comma for a point": ("1570.000", "1570,000", "something else than numbers"),
    "a letter": ("1570.000", "157O.000", "something else than numbers"),
    "an empty field": ("309.5000;", ";", "fewer than 11"),
    "a twelfth number": ("0;0;0;1;", "0;0;0;1;0;", "more than 11"),
    "a configuration out of range": ("0;0;0;1;", "0;0;0;8;", "out of range"),
    "half a quarter turn": ("0;0;0;1;", "0;0.5;0;1;", "out of range"),
    "another version": ("#doormill 1", "#doormill 2", "another version"),
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
    "an arc first": ('["J",1,0,500', '["C",1,2,500', "first motion"),
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
    if "spindle" not in words and "first motion" not in words:
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
    robot = controller(start=np.radians([0.0, 0.0, 0.0, 0.0, 20.0, 0.0]))
    put(robot, good)
    robot.run()
    assert "The robot is not at home." in robot.pendant_lines
    assert robot.moves == []
    assert robot.io.history == []
    robot.program.run("MoveHome")
    robot.run()
    assert robot.io.read("doPathDone") == 1


def test_a_door_that_comes_loose_stops_the_robot_and_then_the_spindle(good, controller):
    robot = controller()
    put(robot, good)

    def loosen(c):
        if c.motion_count >= 5:
            c.cell.set_input("diDoorClamped", 0.0)

    robot._on_time = loosen
    robot.run()
    assert "The door was released while milling." in robot.pendant_lines
    assert robot.read_signal("doSpindleOn") == 0.0
    assert [robot.io.read(s) for s in ("doPathFault", "doPathBusy", "doPathDone")] == [1, 0, 0]
    assert len(robot.moves) < 10


def test_ready_that_stays_high_from_before_is_not_taken_for_an_answer(good, controller):
    robot = controller(on_wait=lambda c: None, patience=None)
    put(robot, good)
    robot.io.write("doPathReady", 1)
    robot.run()
    assert "A signal did not come in time." in robot.pendant_lines
    assert ("doPathRequest", 1) not in robot.io.history
    assert robot.moves == []


def test_a_pc_that_never_answers_does_not_keep_the_robot_for_ever(controller):
    robot = controller(on_wait=lambda c: None, patience=None)
    robot.run()
    assert "A signal did not come in time." in robot.pendant_lines
    assert robot.now() >= 600.0
    assert robot.io.read("doPathRequest") == 0
