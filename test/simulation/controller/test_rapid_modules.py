"""The shipped RAPID modules, judged as a RAPID programmer would judge them before loading."""

from __future__ import annotations

import re

import pytest

from doormill_ros.abb.signals import (
    ALL_SIGNALS,
    GROUP_SIGNALS,
    LARGEST_NUMBER,
    PC_SIGNALS,
    READY_NUMBER,
    SPINDLE_LOAD,
    TARGET_FILE,
)
from doormill_ros.abb.target_file import checksum
from doormill_ros.abb.target_file import line as target_line
from doormill_ros.abb.target_file import move as target_move
from doormill_ros.abb.target_file import trailer as target_trailer
from doormill_ros.cell import rapid_limits
from doormill_ros.resources import resource
from doormill_ros.simulation.controller.configuration.event_routines import read_event_routines
from doormill_ros.simulation.controller.configuration.installed import OWN_MODULES
from doormill_ros.simulation.controller.configuration.io_configuration import read_io_configuration
from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.rapid.program import RapidProgram

TEXTS = {name: resource(name).read_bytes() for name in OWN_MODULES}
MODULES = {name: parse_module(text.decode("latin-1"), name) for name, text in TEXTS.items()}


def nodes(node):
    """Every node of a syntax tree."""
    if isinstance(node, s.Node):
        yield node
        for value in vars(node).values():
            yield from nodes(value)
    elif isinstance(node, tuple):
        for item in node:
            yield from nodes(item)


def calls(name: str):
    for file, module in MODULES.items():
        for node in nodes(module):
            if isinstance(node, s.Call) and node.name.lower() == name.lower():
                yield file, node


def option(call: s.Call, name: str) -> s.Argument | None:
    return next((a for a in call.arguments if a.name.lower() == name.lower()), None)


@pytest.mark.parametrize("name", OWN_MODULES)
def test_a_module_file_is_plain_text_that_every_controller_loads(name):
    text = TEXTS[name]
    assert b"\r" not in text
    assert b"\t" not in text
    assert text.isascii()
    assert text.endswith(b"ENDMODULE\n")
    assert max(map(len, text.splitlines())) <= 120
    assert MODULES[name].name == name.removeprefix("rapid/").removesuffix(".mod")


def test_no_name_hides_a_predefined_one(machine):
    """A local variable called like an instruction is legal and a trap."""
    machine.signal_kinds = lambda: {}
    empty = RapidProgram([], machine)
    known = {name for name, _ in empty._modules.routines._outer} | {
        name for name, _ in empty._modules.data._outer
    }
    known |= {name for name, _ in empty._modules._types}
    assert {"movel", "strlen", "v100", "robtarget"} <= known
    named = 0
    for file, module in MODULES.items():
        for node in nodes(module):
            if isinstance(node, s.Data | s.Parameter | s.Routine | s.Record | s.For):
                assert node.name.lower() not in known, (file, node.line, node.name)
                named += 1
    assert named > 100


def test_what_the_spindle_owes_has_an_end_and_what_people_owe_has_none():
    """A door, its name, the PC and a guard may take their time; drive and drawbar may not."""
    limited: dict[str, set[bool]] = {}
    for _, call in calls("WaitDI"):
        signal = call.arguments[0].value.name
        limited.setdefault(signal, set()).add(option(call, "MaxTime") is not None)
    machines = ("diSpindleAtSpeed", "diSpindleStopped", "diToolReleased", "diToolClamped")
    people = ("diDoorClamped", "diGuardClosed")
    assert limited == {name: {name in machines} for name in (*machines, *people)}
    untimed = [call for _, call in calls("WaitUntil") if option(call, "MaxTime") is None]
    assert len(untimed) == 4
    timed = [call for name in ("WaitDI", "WaitUntil") for _, call in calls(name) if option(call, "MaxTime")]
    assert timed
    assert all(option(call, "TimeFlag") for call in timed)


@pytest.mark.parametrize("name", ["MoveL", "MoveC", "MoveAbsJ"])
def test_every_motion_names_tool_and_work_object(name):
    found = list(calls(name))
    assert found
    for file, call in found:
        arguments = [a.value.name for a in call.arguments if isinstance(a.value, s.Variable)]
        assert "toolMill" in arguments, (file, call.line)
        assert option(call, "WObj").value.name == "wobjDoor", (file, call.line)


def test_no_motion_ends_in_a_configuration_that_a_calibrated_arm_may_not_have():
    """MoveJ takes confdata at its word, MoveL and MoveC with ConfL\\Off do not, and MoveAbsJ has none."""
    assert not list(calls("MoveJ"))
    assert all(any(a.name == "Off" for a in call.arguments) for _, call in calls("ConfL"))


def test_errors_reach_a_handler_and_handlers_never_fall_through():
    """main has a handler, and each handler ends by saying where to go on."""
    main = next(r for m in MODULES.values() for r in m.routines if r.name == "main")
    assert main.handler
    handlers = 0
    for file, module in MODULES.items():
        for routine in module.routines:
            if routine.handler is not None:
                last = routine.handler[-1]
                assert isinstance(last, s.TryNext | s.Return), (file, routine.name)
                handlers += 1
    assert handlers == sum(text.count(b"\n    ERROR\n") for text in TEXTS.values()) > 1


def test_numbers_stand_in_constants():
    """In statements there are no numbers beyond 0, 1 and 2 and powers of ten for NumToStr."""
    numbers = 0
    for file, module in MODULES.items():
        for routine in module.routines:
            for node in nodes((routine.body, routine.handler or ())):
                if isinstance(node, s.Number):
                    assert node.value in (0.0, 1.0, 2.0), (file, node.line, node.value)
                    numbers += 1
    assert numbers > 10


def test_module_and_python_agree_on_every_limit(machine):
    machine.signal_kinds = lambda: read_io_configuration(resource("rapid/EIO.cfg")).kinds
    read = RapidProgram(list(MODULES.values()), machine).read
    assert read("TARGET_FILE") == TARGET_FILE
    assert read("FILE_VERSION") == target_trailer.VERSION
    assert read("MAX_TARGETS") == rapid_limits.MAX_TARGETS == len(read("targets"))
    assert read("MAX_MOVES") == rapid_limits.MAX_MOTIONS == len(read("moves"))
    assert read("MAX_FEATURES") == rapid_limits.MAX_FEATURES == len(read("features"))
    assert read("MAX_POINTS") == rapid_limits.MAX_POINTS == len(read("points"))
    assert read("MAX_ESCAPE") == rapid_limits.MAX_ESCAPE == len(read("escape"))
    assert (
        read("MAX_PLACES") == rapid_limits.MAX_PLACES == len(read("rackFronts")) == len(read("toolLengths"))
    )
    assert read("MAX_SPEED") == pytest.approx(target_move.MAX_SPEED * 1e3)
    assert read("MAX_SPINDLE_SPEED") == pytest.approx(target_move.MAX_SPINDLE_SPEED * 60 / 6.283185307)
    assert read("UNIT_TOLERANCE") == pytest.approx(target_line.NORM_TOLERANCE)
    text = TEXTS["rapid/DoorLine.mod"].decode()
    for name in ("FACTOR_A", "MODULUS_A", "FACTOR_B", "MODULUS_B", "CODES", "LINE_FEED"):
        assert re.search(rf"LOCAL CONST num {name}:={getattr(checksum, name)};", text), name
    text = TEXTS["rapid/DoorPath.mod"].decode()
    for zone in target_move.ZONES:
        assert f'CASE "{zone}":\n            RETURN {zone};' in text


def test_both_robotwares_load_the_same_modules_in_the_order_of_their_use():
    """A copy for each, since a controller follows no links; `cp DoorX.mod rw7/DoorX.modx` brings one up to date."""
    folder = resource("rapid")
    assert {path.name for path in folder.glob("*.mod")} == {
        name.removeprefix("rapid/") for name in OWN_MODULES
    }
    assert len(list((folder / "rw7").glob("*.modx"))) == len(OWN_MODULES)
    for name, text in TEXTS.items():
        assert (folder / "rw7" / f"{name.removeprefix('rapid/')}x").read_bytes() == text, name
    for parameters, ending in (("SYS.cfg", "mod"), ("rw7/SYS.cfg", "modx")):
        loaded = re.findall(rf'-File "HOME:/(\w+)\.{ending}" -Task', (folder / parameters).read_text())
        assert loaded == [name.removeprefix("rapid/").removesuffix(".mod") for name in OWN_MODULES]
    for parameters in ("EIO.cfg", "SYS.cfg"):
        old, new = ((folder / place / parameters).read_text().split("\n", 1) for place in ("", "rw7"))
        assert (old[0][4:12], new[0][4:12]) == ("CFG_1.0:", "CFG_1.0:")
        assert (old[0].split(":")[2], new[0].split(":")[2]) == ("6", "7")
        assert new[1].replace(".modx", ".mod") == old[1]


@pytest.mark.parametrize("place", ["rapid", "rapid/rw7"])
def test_no_way_to_go_on_leaves_out_what_holds_the_robot(place: str) -> None:
    """The step button goes on along the path as a start does; its event is one of its own."""
    routines = read_event_routines(resource(place) / "SYS.cfg")
    for event in ("START", "STEP", "RESTART"):
        assert routines[event] == ("DoorRestarted",), event


def test_the_newer_robotwares_files_run(controller):
    folder = resource("rapid") / "rw7"
    robot = controller(
        modules=[folder / f"{name.removeprefix('rapid/')}x" for name in OWN_MODULES],
        io_configuration=folder / "EIO.cfg",
        system_parameters=folder / "SYS.cfg",
    )
    robot.run()
    assert robot.pendant_lines[-2:] == ["The target file is missing.", TARGET_FILE]


def test_the_configured_signals_are_those_that_are_used():
    signals = read_io_configuration(resource("rapid/EIO.cfg")).signals
    used = {
        node.name
        for module in MODULES.values()
        for node in nodes(module)
        if isinstance(node, s.Variable) and re.fullmatch(r"[adg][io][A-Z]\w+", node.name)
    }
    others = {
        "doSpindleRun",
        "doDrawbarRun",
        "soCycleOn",
        SPINDLE_LOAD,
    }  # of the controller itself, and read by the PC alone
    assert used | others == set(signals)
    assert not used & others
    assert set(ALL_SIGNALS) | set(GROUP_SIGNALS) <= set(signals)
    assert signals[READY_NUMBER].largest == LARGEST_NUMBER
    assert signals["aoSpindleSpeed"].largest == 24000.0
    # The PC may write its own signals and no other.
    text = re.sub(r"\\\s*\n", " ", resource("rapid/EIO.cfg").read_text())
    writable = {re.search(r'-Name "(\w+)"', line)[1] for line in text.splitlines() if '-Access "All"' in line}
    assert writable == {*PC_SIGNALS, *GROUP_SIGNALS}


def test_the_robot_stands_before_each_signal_of_the_cell():
    """MoveHome and the approach end in stop points; between them ZoneBetween decides."""
    found = list(calls("MoveAbsJ"))
    assert len(found) >= 2
    for _, call in found:
        zone = [a.value for a in call.arguments if not a.name][2]
        assert zone.name in ("fine", "zone")
