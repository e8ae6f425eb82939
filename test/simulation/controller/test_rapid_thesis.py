"""The thesis' own program, figures 3.36 to 3.41, executed on our target files."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file
from doormill_ros.frames import inverse, quaternion_wxyz
from doormill_ros.simulation.controller.rapid.errors import RapidRuntimeError, RapidSyntaxError
from doormill_ros.simulation.controller.rapid.parser import parse_module
from doormill_ros.simulation.controller.rapid.program import RapidProgram
from doormill_ros.simulation.controller.records.process import listed_process
from doormill_ros.toolpath.program import MillingProgram
from support.thesis_listings import Repair, load_listings

NAMES = ["init", "10", "11", "12", "13", "14", "15", "init2", "20", "21", "22", "23", "24", "25"]
DOORS = ["thesis_190_0deg", "thesis_190_2deg", "thesis_1350_0deg", "thesis_1350_2deg"]


def robtarget(T: np.ndarray, conf) -> str:
    position, quaternion = T[:3, 3] * 1e3, quaternion_wxyz(T)
    numbers = [",".join(f"{v:.6f}" for v in part) for part in (position, quaternion)]
    return f"[[{numbers[0]}],[{numbers[1]}],[{conf.cf1},{conf.cf4},{conf.cf6},{conf.cfx}],[9E9,9E9,9E9,9E9,9E9,9E9]]"


@pytest.fixture
def thesis_controller(tmp_path, controller, thesis_module):
    """A controller with the thesis' module; its home targets stand 200 mm in front of the door."""

    def thesis_controller_(program: MillingProgram, data: bytes, **kwargs):
        first, second = program.targets[0], program.targets[7]
        T_home = first.T_base_tool_corrected.copy()
        T_home[0, 3] -= 0.2
        T_flange_tool = np.eye(4)
        T_flange_tool[2, 3] = 0.25
        T_home2 = second.T_base_tool_corrected @ inverse(T_flange_tool)  # tool0: the flange itself
        T_home2[0, 3] -= 0.2
        module = tmp_path / "Thesis.mod"
        module.write_text(thesis_module(robtarget(T_home, first.conf), robtarget(T_home2, second.conf)))
        (tmp_path / "Hei2.txt").write_bytes(data)
        return controller(modules=[module], expected_door=None, **kwargs)

    return thesis_controller_


@pytest.mark.parametrize("name", DOORS)
def test_the_thesis_program_mills_our_two_hinge_file_unchanged(name, door, thesis_controller):
    program = door(name)
    file = render_target_file(program, "run-1")
    controller = thesis_controller(program, file, process=listed_process(program))
    controller.run()
    assert [entry for entry in controller.event_log if entry.kind == "error"] == []
    # Path_20 of figure 3.41 written as (kind, circle point, target).
    expected = [("MoveL", None, "init")]
    for eleven, ten, twelve, fourteen, fifteen, thirteen, away in (
        ("11", "10", "12", "14", "15", "13", "init"),
        ("21", "20", "22", "24", "25", "23", "init2"),
    ):
        if away == "init2":
            expected.append(("MoveL", None, "init2"))
        expected += [("MoveL", None, eleven), ("MoveC", ten, twelve), ("MoveL", None, fourteen)]
        expected += [("MoveC", fifteen, thirteen), ("MoveL", None, eleven), ("MoveL", None, away)]
    told = [controller.program.read(f"Target_{n}") for n in NAMES]
    names = {tuple(map(tuple, t[:3])): n for n, t in zip(NAMES, told, strict=True)}
    moves = list(controller.moves[1:-1])
    assert [
        (m.kind, m.via and names[tuple(map(tuple, m.via[:3]))], names[tuple(map(tuple, m.target[:3]))])
        for m in moves
    ] == expected
    path = controller.executed_path()
    assert set(path.motion[path.cutting]) == {i for i, m in enumerate(program.motions) if m.cutting}


@pytest.mark.parametrize("repair", load_listings()[1], ids=lambda repair: repair.printed)
def test_what_the_thesis_prints_there_is_no_rapid(repair: Repair, thesis_module):
    text, listing = thesis_module(), load_listings()[0][repair.figure]
    parse_module(text, "Thesis.mod")
    assert (text.count(listing), listing.count(repair.meant)) == (1, 1)
    with pytest.raises(RapidSyntaxError):
        parse_module(text.replace(listing, listing.replace(repair.meant, repair.printed)), "Thesis.mod")


def test_every_number_arrives_within_half_a_decimal_and_float32(door, thesis_controller):
    program = door(
        "thesis_1350_2deg", 0.004, -0.003, -0.005
    )  # its program supervises configurations: off their borders
    file = render_target_file(program, "run-1")
    controller = thesis_controller(program, file)
    controller.run()
    read = read_target_file(file).targets
    for name, target, line in zip(NAMES, program.targets, read, strict=True):
        trans, rot, conf, extax = controller.program.read(f"Target_{name}")
        wanted = target.T_base_tool_corrected[:3, 3] * 1e3
        spacing = np.spacing(np.abs(wanted).astype(np.float32)).astype(float)
        assert np.all(
            np.abs(np.array(trans) - wanted) <= line.position_resolution * 1e3 + 0.5 * spacing + 1e-9
        )
        assert np.abs(np.array(rot) - quaternion_wxyz(target.T_base_tool_corrected)).max() <= (
            line.quaternion_resolution + 2.0**-24
        )
        assert tuple(conf) == (target.conf.cf1, target.conf.cf4, target.conf.cf6, target.conf.cfx)
        # The listing never sets the external axes, so they stay at the default of a VAR.
        assert extax == [0.0] * 6


def test_a_field_that_is_no_number_keeps_the_default_and_is_not_noticed(machine, thesis_module):
    """StrToVal fails, its result is thrown away, tmpTarget keeps what it had: figure 3.39."""
    lines = [f"{100 + i}.0;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;" for i in range(14)]
    lines[3] = "1,5;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;"
    (machine.home / "Hei2.txt").write_text("\n".join(lines) + "\n")
    program = RapidProgram([parse_module(thesis_module(path=False), "Thesis.mod")], machine)
    program.run()
    assert program.read("Target_11")[0] == [102.0, 2.0, 3.0]
    assert program.read("Target_12")[0] == [0.0, 2.0, 3.0]


@pytest.mark.parametrize("targets", [0, 1, 7, 13])
def test_fewer_than_14_targets_stop_the_thesis_program_before_it_moves(targets, door, machine, thesis_module):
    whole = render_target_file(door("thesis_190_0deg"), "run-1").decode().splitlines()
    trailer = [line for line in whole if line.startswith("#")]
    (machine.home / "Hei2.txt").write_text("\n".join(whole[:targets] + trailer) + "\n")
    program = RapidProgram([parse_module(thesis_module(), "Thesis.mod")], machine)
    with pytest.raises(RapidRuntimeError, match=r"StrFind: position .* is outside the string"):
        program.run()
    assert machine.moves == []


def test_a_missing_separator_stops_the_thesis_program(machine, thesis_module):
    lines = ["1.0;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;"] * 13 + ["1.0;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0"]
    (machine.home / "Hei2.txt").write_text("\n".join(lines) + "\n")
    program = RapidProgram([parse_module(thesis_module(path=False), "Thesis.mod")], machine)
    with pytest.raises(RapidRuntimeError, match=r"Thesis.mod, line \d+: StrFind: position 35 is outside"):
        program.run()


def test_a_line_of_more_than_80_characters_shifts_all_that_is_read_after_it(
    machine, thesis_module, thesis_listings
):
    """With ReadStr counting calls instead of lines; \\Line counts lines, so the listing is immune."""
    lines = [f"{100 + i}.0;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;" for i in range(14)]
    lines[1] = lines[1] + "9" * (81 - len(lines[1]))
    (machine.home / "Hei2.txt").write_text("\n".join(lines) + "\n")
    text = thesis_module(path=False)
    assert text.count("\\Line:=") == 13
    program = RapidProgram([parse_module(text, "Thesis.mod")], machine)
    program.run()
    assert program.read("Target_11")[0][0] == 102.0
    import re

    sequential = re.sub(r"\\Line:=\d+", "", text)
    program = RapidProgram([parse_module(sequential, "Thesis.mod")], machine)
    with pytest.raises(RapidRuntimeError, match="StrFind"):
        program.run()
