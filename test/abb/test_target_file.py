"""The target file: format, budget, and what its reader refuses."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from doormill_ros.abb.errors import (
    AbbError,
    StaleRunError,
    TargetFileChecksumError,
    TargetFileCutShortError,
    TargetFileWriteError,
    TargetLineError,
    TargetProgramError,
    TargetValueError,
    WrongDoorError,
)
from doormill_ros.abb.target_file.checksum import (
    CODES,
    FACTOR_A,
    FACTOR_B,
    MODULUS_A,
    MODULUS_B,
    checksum,
)
from doormill_ros.abb.target_file.line import TargetLine, format_lines, parse_lines
from doormill_ros.abb.target_file.target_file import read_target_file, render_target_file, write_target_file
from doormill_ros.frames import transform
from doormill_ros.robot.configuration import ConfData
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.units import RPM

LINE = re.compile(r"(-?\d+\.\d+;){7}(-?\d;){4}")
ANY = ConfData(0, 0, 0, 0)
LARGEST_EXACT = 2**23  #: integers up to here are exact in a RAPID num


def format_line(T_base_tool: np.ndarray, conf: ConfData, name: str = "") -> str:
    return format_lines([T_base_tool], [conf], [name])[0]


def parse_line(line: str, number: int = 1) -> TargetLine:
    return parse_lines([line], number)[0]


def pose(position, quaternion_wxyz=(1.0, 0.0, 0.0, 0.0)) -> np.ndarray:
    w, x, y, z = quaternion_wxyz
    return transform(Rotation.from_quat([x, y, z, w]).as_matrix(), np.array(position))


coordinates = st.floats(-9.9999, 9.9999)
components = st.floats(-1.0, 1.0)
unit_quaternions = (
    st.tuples(components, components, components, components)
    .filter(lambda q: np.linalg.norm(q) > 1e-3)
    .map(lambda q: tuple(np.array(q) / np.linalg.norm(q)))
)
confs = st.builds(ConfData, st.integers(-4, 3), st.integers(-4, 3), st.integers(-4, 3), st.integers(0, 7))


@settings(max_examples=400)
@given(position=st.tuples(coordinates, coordinates, coordinates), quaternion=unit_quaternions, conf=confs)
def test_a_line_holds_any_pose_within_the_budget_and_gives_it_back(position, quaternion, conf):
    T = pose(position, quaternion)
    line = format_line(T, conf)
    assert len(line) <= 80
    assert LINE.fullmatch(line), line
    back = parse_line(line, 1)
    spacing = np.spacing(np.abs(T[:3, 3] * 1e3).astype(np.float32)).astype(float)
    # Half of the last decimal; the double may sit on the border itself.
    assert np.all(
        np.abs(back.position_mm - T[:3, 3] * 1e3) <= back.position_resolution * 1e3 * (1 + 1e-9) + 1e-12
    )
    # As useful decimals as float32 has: coarser than 3 decimals only where float32 is.
    assert np.all(back.position_resolution * 1e3 <= np.maximum(0.5e-3, 5.0 * spacing))
    wanted = np.array(quaternion)
    error = min(np.abs(back.quaternion - wanted).max(), np.abs(back.quaternion + wanted).max())
    assert error <= back.quaternion_resolution + 1e-12
    assert abs(back.quaternion @ back.quaternion - 1.0) < 1e-5
    assert back.quaternion[np.flatnonzero(back.quaternion)[0]] > 0.0
    assert "-0.0000000" not in line
    assert "-0.000000;" not in line
    assert back.conf == conf


@settings(max_examples=300)
@given(position=st.tuples(coordinates, coordinates, coordinates), quaternion=unit_quaternions)
def test_every_written_number_survives_float32(position, quaternion):
    """What a num holds rounds back to the decimals that were written: none of them is noise."""
    line = format_line(pose(position, quaternion), ANY)
    numbers = line.split(";")[:7]
    assert len(numbers) == 7
    for text in numbers:
        decimals = len(text.partition(".")[2])
        assert f"{float(np.float32(float(text))):.{decimals}f}" == text


@pytest.mark.parametrize(
    ("position", "quaternion", "start"),
    [
        # Golden lines by hand: 0.5 mm steps, exact quaternions; 1.57 m has ulp 0.00012 mm: 3 decimals.
        ((1.57, 0.0, 0.0005), (1.0, 0.0, 0.0, 0.0), "1570.000;0.0000;0.5000;1.0000000;" + "0.0000000;" * 3),
        (
            (0.25, -0.5, -2.0),
            (0.0, 0.0, -1.0, 0.0),
            "250.0000;-500.0000;-2000.000;0.0000000;0.0000000;1.0000000;0.0000000;",
        ),
        ((0.0, 0.0, 0.0), (-0.6, 0.0, 0.8, 0.0), "0.0000;0.0000;0.0000;0.6000000;0.0000000;-0.8000000;0.0000000;"),
    ],
)  # fmt: skip
def test_golden_lines(position, quaternion, start):
    assert format_line(pose(position, quaternion), ConfData(-1, 0, -2, 5)) == start + "-1;0;-2;5;"


def test_the_longest_line_still_fits():
    q = np.array([0.5123456, -0.5123456, -0.4873456, -0.4873456])
    line = format_line(
        pose((-9.876543, -9.876543, -9.876543), q / np.linalg.norm(q)), ConfData(-4, -4, -4, 7)
    )
    assert len(line) <= 80
    assert [len(t.partition(".")[2]) for t in line.split(";")[:7]] == [3, 3, 3, 6, 6, 6, 6]


def test_lines_of_the_cell_leave_room_for_the_line_feed(door):
    for name in ("thesis_1350_2deg", "standard_door"):
        lines = render_target_file(door(name), "run-1").decode().splitlines()
        assert max(map(len, lines)) <= 79


@pytest.mark.parametrize(
    ("T", "conf", "words"),
    [
        (pose((10.0, 0.0, 0.0)), ANY, "less than 10 m"),
        (np.eye(3), ANY, "shape"),
        (np.full((4, 4), np.nan), ANY, "not finite"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), ANY, "not a rotation"),
        (np.eye(4), ConfData(0, 0, 0, 8), "cfx = 8"),
        (np.eye(4), ConfData(0, 5, 0, 0), "cf4 = 5"),
        (np.eye(4), ConfData(0.5, 0, 0, 0), "cf1 = 0.5"),
    ],
)
def test_what_no_line_can_hold_is_refused(T, conf, words):
    with pytest.raises(TargetValueError, match=words):
        format_line(T, conf, "11")


# The whole file


@pytest.fixture
def program(door) -> MillingProgram:
    return door("thesis_190_0deg")


def test_the_file_of_a_two_hinge_door_has_the_14_targets_first_and_in_order(program):
    data = render_target_file(program, "run-1")
    lines = data.decode("ascii").splitlines()
    assert data.endswith(b"\n")
    assert b"\r" not in data
    assert " ".join(t.name for t in program.targets) == "init 10 11 12 13 14 15 init2 20 21 22 23 24 25"
    assert all(LINE.fullmatch(line) for line in lines[:14])
    assert all(line.startswith("#") and ";" not in line for line in lines[14:])


def test_reading_gives_back_what_was_written(door):
    program = door("standard_door")
    file = read_target_file(render_target_file(program, "20260314T101500-3f2a"))
    assert (file.door_id, file.run_id) == (program.door_id, "20260314T101500-3f2a")
    assert file.recipe_version == program.recipe_version
    assert len(file.targets) == len(program.targets)
    for line, target in zip(file.targets, program.targets, strict=True):
        shift = line.T_base_tool[:3, 3] - target.T_base_tool_corrected[:3, 3]
        assert np.abs(shift).max() <= 0.5e-6 + 1e-12
        assert line.conf == target.conf
    assert len(file.motions) == len(program.motions)
    for found, wanted in zip(file.motions, program.motions, strict=True):
        for name in ("kind", "target", "via", "zone", "feature", "cutting"):
            assert getattr(found, name) == getattr(wanted, name)
        assert abs(found.speed - wanted.speed) <= 0.5e-6
        assert abs(found.spindle_speed - wanted.spindle_speed) <= 0.5e-3 * RPM + 1e-9
    assert file.escapes == program.escapes
    assert len(file.escapes) == len(program.features) == 6
    assert len(file.points) == len(program.points) > 6
    half = np.deg2rad(0.5e-4) + 1e-12
    np.testing.assert_allclose([file.home, *file.points], [program.home, *program.points], rtol=0, atol=half)


WRONG_WAYS = {
    "no home": {"home": None},
    "home of five joints": {"home": np.zeros(5)},
    "home not a number": {"home": np.full(6, np.nan)},
    "a turn too far": {"home": np.array([0.0, 0.0, 0.0, 0.0, 0.0, 20.0])},
    "a feature without a way home": {"escapes": (range(1),)},
    "a way home of points that are not there": {"escapes": (range(1), range(98, 99))},
    "an empty way home": {"escapes": (range(1), range(1, 1))},
    "a way home longer than the module keeps": {
        "escapes": (range(1), range(21)),
        "points": (np.zeros(6),) * 30,
    },
    "a point of five joints": {"points": (np.zeros(5),) * 6},
    "more points than the module keeps": {"points": (np.zeros(6),) * 501},
}


@pytest.mark.parametrize("change", WRONG_WAYS.values(), ids=WRONG_WAYS)
def test_ways_that_the_module_would_refuse_are_not_written(program, change):
    with pytest.raises((TargetProgramError, TargetValueError)):
        render_target_file(replace(program, **change), "run")


def test_a_motion_to_a_point_counts_points_and_one_to_a_target_targets(program):
    absolute = next(i for i, motion in enumerate(program.motions) if motion.kind is MotionKind.ABSOLUTE)
    for target, good in ((len(program.points) - 1, True), (len(program.points), False)):
        motions = list(program.motions)
        motions[absolute] = replace(motions[absolute], target=target)
        changed = replace(program, motions=tuple(motions))
        if good:
            assert read_target_file(render_target_file(changed, "run")).motions[absolute].target == target
        else:
            with pytest.raises(TargetProgramError, match=f"motion {absolute} "):
                render_target_file(changed, "run")


@pytest.mark.parametrize(
    ("line", "wrong", "words"),
    [
        ("#home ", "#home [0,0,0,0,0]", "6 joint angles"),
        ("#home ", "#home [0,0,0,0,0,1e3]", "6 joint angles"),
        ("#point ", "#point [0,0,0,0,0,0,0]", "6 joint angles"),
        ("#points ", "#points 501", "0 to 500"),
        ("#escape ", "#escape [2,1]", "first and last of"),
        ("#escape ", "#escape [0,1]", "first and last of"),
        ("#escape ", "#escape [1,99]", "first and last of"),
        ('#move ["A"', '#move ["A",99,0,500,"fine",0,FALSE,0]', "1 to"),
        ('#move ["A"', '#move ["A",1,1,500,"fine",0,FALSE,0]', "0 without circle"),
    ],
)
def test_a_way_that_cannot_be_is_named_with_its_line(program, line, wrong, words):
    lines = render_target_file(program, "run").decode().splitlines()[:-1]
    at = next(i for i, text in enumerate(lines) if text.startswith(line))
    lines[at] = wrong
    a, b = checksum(lines)
    data = "".join(text + "\n" for text in [*lines, f"#sum [{a},{b}]"]).encode()
    with pytest.raises(TargetLineError, match=f"line {at + 1} .*{re.escape(words)}"):
        read_target_file(data)


def test_every_cut_is_named(program):
    data = render_target_file(program, "run-1")
    assert data.count(b"\n") > len(program.targets) + len(program.motions)
    for length in range(len(data)):
        with pytest.raises((TargetFileCutShortError, TargetLineError)):
            read_target_file(data[:length])


@settings(max_examples=200)
@given(data=st.data())
def test_every_changed_byte_is_noticed(data, changed_base):
    at = data.draw(st.integers(0, len(changed_base) - 1))
    byte = data.draw(st.integers(0, 255).filter(lambda value: value != changed_base[at]))
    with pytest.raises(AbbError):
        read_target_file(changed_base[:at] + bytes([byte]) + changed_base[at + 1 :])


@pytest.fixture(scope="module")
def changed_base(door) -> bytes:
    return render_target_file(door("thesis_190_0deg"), "run-1")


def test_a_changed_digit_is_a_wrong_checksum(program):
    data = render_target_file(program, "run-1")
    assert data.startswith(b"1845.000")
    with pytest.raises(TargetFileChecksumError, match="write the file anew"):
        read_target_file(b"1845.001" + data[8:])


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("1,5;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;", "line 1 .* x = '1,5', allowed is a decimal"),
        ("1.5;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0", "10 separators"),
        ("1.5;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;0;", "12 separators"),
        ("1.5;2.0;3.0;1.0;0.0;0.0;0.1;0;0;0;0;", "squares sum to 1.01"),
        ("1.5;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;8;", "cfx = 8, allowed is 0 to 7"),
        ("1.5;2.0;3.0;1.0;0.0;0.0;0.0;0;1.0;0;0;", "cf4 = '1.0', allowed is an integer"),
        ("nan;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;", "x = 'nan'"),
        ("1e3;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;", "x = '1e3'"),
        (" 1.5;2.0;3.0;1.0;0.0;0.0;0.0;0;0;0;0;", "x = ' 1.5'"),
        ("1" * 81, "81 characters"),
        ("", "0 separators"),
    ],
)
def test_a_bad_line_is_named_with_number_found_and_allowed(line, words):
    with pytest.raises(TargetLineError, match=words) as caught:
        read_target_file((line + "\n").encode(), trailer=False)
    assert caught.value.data["line"] == 1


@pytest.mark.parametrize(
    ("data", "error", "words"),
    [
        (b"", TargetFileCutShortError, "empty"),
        (b"1.5;", TargetFileCutShortError, "no line feed"),
        (b"1.5;\r\n", TargetLineError, "byte 0x0D"),
        (b"\xff\xfe\n", TargetLineError, "byte 0xFF"),
        (b"#doormill 2\n", TargetFileCutShortError, "#door"),
        (b"\n" * 5000, TargetLineError, "5000 lines"),
        (b"x" * 2_000_000, TargetLineError, "2000000 bytes"),
    ],
)
def test_what_is_no_target_file_is_named(data, error, words):
    with pytest.raises(error, match=words):
        read_target_file(data)


def test_another_door_and_a_run_seen_before_are_refused(program):
    file = read_target_file(render_target_file(program, "run-7"))
    file.check_for(program.door_id, ("run-6",))
    with pytest.raises(WrongDoorError, match="'thesis_190_0deg', the door in the cell is 'other'"):
        file.check_for("other")
    with pytest.raises(StaleRunError, match="run-7"):
        file.check_for(program.door_id, ("run-6", "run-7"))


@pytest.mark.parametrize("name", ["", " x", "x ", "a;b", 'a"b', "a\\b", "a\nb", "dør", "x" * 76, '["'])
def test_names_that_a_rapid_string_cannot_hold_are_refused(program, name):
    with pytest.raises(TargetValueError):
        render_target_file(program, name)
    with pytest.raises(TargetValueError):
        render_target_file(replace(program, door_id=name), "run")


@pytest.mark.parametrize(
    "change",
    [
        {"target": 14},
        {"target": -1},
        {"via": 3},
        {"kind": MotionKind.CIRCULAR},
        {"zone": "z2"},
        {"speed": 0.0},
        {"speed": 7.1},
        {"speed": 4e-7},
        {"spindle_speed": -1.0},
        {"spindle_speed": 24001 * RPM},
    ],
)
def test_motions_that_the_module_would_refuse_are_not_written(program, change):
    motions = (program.motions[0], replace(program.motions[1], **change), *program.motions[2:])
    with pytest.raises(TargetProgramError, match="motion 1 "):
        render_target_file(replace(program, motions=motions), "run")


def test_empty_programs_are_refused(program):
    for empty in (replace(program, targets=()), replace(program, motions=())):
        with pytest.raises(AbbError):
            render_target_file(empty, "run")


# Checksum


def test_every_step_of_the_checksum_is_exact_in_float32():
    for factor, modulus in ((FACTOR_A, MODULUS_A), (FACTOR_B, MODULUS_B)):
        largest = factor * (modulus - 1) + CODES * CODES
        assert largest < LARGEST_EXACT
        assert np.float32(largest) == largest
        assert all(modulus % d for d in range(2, int(modulus**0.5) + 1))  # a prime loses nothing


@given(lines=st.lists(st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=80), max_size=5))
def test_the_checksum_in_float32_is_the_checksum_in_integers(lines):
    sums = [np.float32(1), np.float32(1)]
    for line in lines:
        codes = [ord(c) for c in line] + ([0] if len(line) % 2 else [])
        pairs = [a * 128 + b for a, b in zip(codes[::2], codes[1::2], strict=True)] + [10]
        for pair in pairs:
            for k, (factor, modulus) in enumerate(((251, 32749), (241, 32719))):
                value = np.float32(np.float32(sums[k] * np.float32(factor)) + np.float32(pair))
                sums[k] = np.float32(int(value) % modulus)
    assert tuple(int(s) for s in sums) == tuple(checksum(lines))


def test_the_checksum_tells_close_contents_apart():
    """All single changes of one pair give different sums: both moduli are larger than any pair."""
    seen = {tuple(checksum([chr(a) + chr(b)])) for a in range(32, 127) for b in range(32, 127)}
    assert len(seen) == 95 * 95


# Writing


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path: Path, monkeypatch):
    path = tmp_path / "Hei2.txt"
    write_target_file(path, b"old\n")
    assert path.read_bytes() == b"old\n"
    write_target_file(path, b"new\n")
    assert path.read_bytes() == b"new\n"

    import os

    def full(_fd):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(TargetFileWriteError, match="No space left"):
        write_target_file(path, b"newer\n")
    monkeypatch.undo()
    assert path.read_bytes() == b"new\n"
    assert [p.name for p in tmp_path.iterdir()] == ["Hei2.txt"]


def test_what_reads_back_differently_is_noticed(tmp_path: Path, monkeypatch):
    path = tmp_path / "Hei2.txt"
    real = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda self: real(self).replace(b"7", b"1"))
    with pytest.raises(TargetFileWriteError, match="first differs at byte 2"):
        write_target_file(path, b"157\n")
    assert not path.exists()


def test_a_missing_folder_is_named(tmp_path: Path):
    with pytest.raises(TargetFileWriteError, match="No such file"):
        write_target_file(tmp_path / "no" / "Hei2.txt", b"x")


def test_a_target_needs_no_trailer_to_be_read(program):
    lines = render_target_file(program, "run").decode().splitlines()[:14]
    file = read_target_file(("\n".join(lines) + "\n").encode(), trailer=False)
    assert len(file.targets) == 14
    assert (file.door_id, file.motions) == ("", ())
    with pytest.raises(TargetLineError, match="line 15"):
        read_target_file(render_target_file(program, "run"), trailer=False)


def test_a_target_without_name_and_feature_is_written():
    T = pose((1.0, 0.0, 0.0))
    target = Target("", T, T, np.zeros(6), ANY, np.zeros(6), np.zeros(6))
    motion = Motion(MotionKind.LINEAR, 0, None, 1.0, "fine", "", False)
    program = MillingProgram("d", 1, (target,), (motion,), home=np.zeros(6))
    file = read_target_file(render_target_file(program, "r"))
    assert file.motions[0].feature == ""
