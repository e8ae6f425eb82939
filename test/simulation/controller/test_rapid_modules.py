"""The shipped RAPID modules, judged as a RAPID programmer would judge them before loading."""

from __future__ import annotations

import re

import pytest

from doormill_ros.abb.signals import ALL_SIGNALS, PC_SIGNALS, TARGET_FILE
from doormill_ros.abb.target_file import checksum
from doormill_ros.abb.target_file import line as target_line
from doormill_ros.abb.target_file import trailer as target_trailer
from doormill_ros.resources import resource
from doormill_ros.simulation.controller.cell import read_io_configuration
from doormill_ros.simulation.controller.controller import OWN_MODULES
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


@pytest.mark.parametrize("name", ["WaitDI", "WaitDO", "WaitUntil"])
def test_every_wait_has_an_end(name):
    found = list(calls(name))
    assert found or name == "WaitUntil"
    for file, call in found:
        assert option(call, "MaxTime") is not None, (file, call.line)


@pytest.mark.parametrize("name", ["MoveJ", "MoveL", "MoveC", "MoveAbsJ"])
def test_every_motion_names_tool_and_work_object(name):
    found = list(calls(name))
    assert found
    for file, call in found:
        arguments = [a.value.name for a in call.arguments if isinstance(a.value, s.Variable)]
        assert "toolMill" in arguments, (file, call.line)
        assert option(call, "WObj").value.name == "wobjDoor", (file, call.line)


def test_errors_reach_a_handler_and_handlers_never_fall_through():
    """main has a handler, and each handler ends by saying where to go on."""
    main = next(r for m in MODULES.values() for r in m.routines if r.name == "main")
    assert main.handler
    handlers = 0
    for file, module in MODULES.items():
        for routine in module.routines:
            if routine.handler is not None:
                last = routine.handler[-1]
                assert isinstance(last, s.TryNext | s.Raise | s.Return | s.Exit), (file, routine.name)
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
    machine.signal_kinds = lambda: read_io_configuration(resource("rapid/EIO.cfg"))[0]
    read = RapidProgram(list(MODULES.values()), machine).read
    assert read("TARGET_FILE") == TARGET_FILE
    assert read("FILE_VERSION") == target_trailer.VERSION
    assert read("MAX_TARGETS") == target_trailer.MAX_TARGETS == len(read("targets"))
    assert read("MAX_MOVES") == target_trailer.MAX_MOTIONS == len(read("moves"))
    assert read("MAX_FEATURES") == target_trailer.MAX_FEATURES == len(read("features"))
    assert read("MAX_SPEED") == pytest.approx(target_trailer.MAX_SPEED * 1e3)
    assert read("MAX_SPINDLE_SPEED") == pytest.approx(target_trailer.MAX_SPINDLE_SPEED * 60 / 6.283185307)
    assert read("UNIT_TOLERANCE") == pytest.approx(target_line.NORM_TOLERANCE)
    text = TEXTS["rapid/DoorFile.mod"].decode()
    for name in ("FACTOR_A", "MODULUS_A", "FACTOR_B", "MODULUS_B", "CODES", "LINE_FEED"):
        assert re.search(rf"LOCAL CONST num {name}:={getattr(checksum, name)};", text), name
    for zone in target_trailer.ZONES:
        assert f'CASE "{zone}":\n            RETURN {zone};' in text


def test_the_configured_signals_are_those_that_are_used():
    kinds, limits = read_io_configuration(resource("rapid/EIO.cfg"))
    used = {
        node.name
        for module in MODULES.values()
        for node in nodes(module)
        if isinstance(node, s.Variable) and re.fullmatch(r"[ad][io][A-Z]\w+", node.name)
    }
    assert used == set(kinds)
    assert set(ALL_SIGNALS) <= set(kinds)
    assert limits == {"aoSpindleSpeed": 24000.0}
    # The PC may write its own signals and no other.
    text = re.sub(r"\\\s*\n", " ", resource("rapid/EIO.cfg").read_text())
    writable = {re.search(r'-Name "(\w+)"', line)[1] for line in text.splitlines() if '-Access "All"' in line}
    assert writable == set(PC_SIGNALS)


def test_the_robot_stands_before_each_signal_of_the_cell():
    """MoveHome and the approach end in stop points; between them ZoneBetween decides."""
    found = [*calls("MoveAbsJ"), *calls("MoveJ")]
    assert len(found) >= 2
    for _, call in found:
        zone = [a.value for a in call.arguments if not a.name][2]
        assert zone.name in ("fine", "zone")
