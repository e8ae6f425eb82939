"""Tracker files and force logs: layouts that are read, and complaints that name file, line and column."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.measurements.errors import RawFileError
from doormill_ros.measurements.raw.raw_files import read_force_log, read_tracker_file

SAMPLES = np.array(
    [[100.0, 1.5, -0.25, 2.0], [100.01, 1.50001, -0.25002, 2.0], [100.02, 1.5, -0.25, 2.00003]]
)


def write(path, rows, separator=" ", header=None):
    lines = [] if header is None else [header]
    lines += [separator.join(repr(float(v)) for v in row) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("separator", [" ", "\t", ",", ";", " , "])
def test_tracker_separators(tmp_path, separator):
    got = read_tracker_file(write(tmp_path / "f.txt", SAMPLES, separator))
    assert got.time == pytest.approx([0, 0.01, 0.02], abs=1e-12)
    assert np.array_equal(got.values, SAMPLES[:, 1:])


def test_header_gives_the_order(tmp_path):
    got = read_tracker_file(
        write(tmp_path / "f.csv", SAMPLES[:, [3, 1, 2, 0]], ",", "Z [m],X [m],Y [m],Time")
    )
    assert np.array_equal(got.values, SAMPLES[:, 1:])


def test_comments_blank_lines_and_trailing_separators(tmp_path):
    path = tmp_path / "f.csv"
    path.write_text("% FARO\n\n0;1;2;3;\n# pause\n1;1;2;3;\n", encoding="utf-8")
    assert read_tracker_file(path).values.tolist() == [[1, 2, 3], [1, 2, 3]]


FORCE = np.arange(18.0).reshape(3, 6)
TIME = np.array([[5.0], [5.5], [6.0]])


@pytest.mark.parametrize(
    ("rows", "header"),
    [
        (np.hstack([TIME, FORCE]), None),
        (np.hstack([FORCE, np.full((3, 4), 9.0), TIME]), None),  # A.16: time in column 11
        (np.hstack([FORCE[:, ::-1], TIME]), "Tz (Nm),Ty (Nm),Tx (Nm),Fz (N),Fy (N),Fx (N),Time (s)"),
    ],
)
def test_force_log_layouts(tmp_path, rows, header):
    got = read_force_log(write(tmp_path / "f.csv", rows, ",", header))
    assert np.array_equal(got.values, FORCE)
    assert got.time.tolist() == [0, 0.5, 1.0]


@pytest.mark.parametrize(
    ("text", "line", "column", "problem"),
    [
        ("0 1 2 3\n1 1 two 3\n", 2, 3, "'two' is no number"),
        ("0;1,5;2;3\n", 1, 2, "decimal point"),
        ("0 1 2 3\n1 1 2\n", 2, 4, "3 columns"),
        ("0 1 2 3\n1 1 2 3 4\n", 2, 5, "5 columns"),
        ("0 1 2\n", 1, 3, "4 (t, x, y, z)"),
        ("0 1 2 3 4\n", 1, 5, "4 (t, x, y, z)"),
        ("0 1 2 3\n1 1 nan 3\n", 2, 3, "not finite"),
        ("0 1 2 3\n1 1 1e999 3\n", 2, 3, "not finite"),
        ("0 1 2 3\n1 1 1_0 3\n", 2, 3, "'1_0' is no number"),
        ("# c\n2 1 2 3\n1 1 2 3\n", 3, 1, "time goes back"),
        ("0 1 2 3\n1 1500.2 2 3\n", 2, 2, "millimetres"),
        ("", 1, 1, "no numbers"),
        ("t x y z\n", 1, 1, "no numbers"),
    ],
)
def test_tracker_complaints(tmp_path, text, line, column, problem):
    path = tmp_path / "FARO_0.txt"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RawFileError, match=re.escape(problem)) as caught:
        read_tracker_file(path)
    assert caught.value.message.startswith(f"{path}: line {line}, column {column}: ")
    assert "\n" not in caught.value.message


@pytest.mark.parametrize(
    ("text", "line", "column", "problem"),
    [
        ("1 2 3 4 5 6\n", 1, 6, "7 (t, fx ... mz)"),
        ("0 1 2 3 4 5 6\n1 1 2 3 4 1e7 6\n", 2, 6, "no force sensor"),
        ("a,b,c\n1,2,3\n", 2, 3, "7 (t, fx ... mz)"),
    ],
)
def test_force_log_complaints(tmp_path, text, line, column, problem):
    path = tmp_path / "force.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RawFileError, match=re.escape(problem)) as caught:
        read_force_log(path)
    assert caught.value.message.startswith(f"{path}: line {line}, column {column}: ")


def test_missing_and_binary_files(tmp_path):
    with pytest.raises(RawFileError, match="cannot be opened"):
        read_tracker_file(tmp_path / "nowhere.txt")
    (tmp_path / "binary.txt").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(RawFileError, match="UTF-8"):
        read_tracker_file(tmp_path / "binary.txt")


@given(st.binary(max_size=200) | st.text("0123456789 .,;-+enaixyzt#%_\t\n", max_size=200).map(str.encode))
def test_any_file_is_read_or_refused_in_one_line(content):
    """No content makes the readers stumble: a recording, or one line that names the file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzz.txt"
        path.write_bytes(content)
        for read in (read_tracker_file, read_force_log):
            message, recording = "", None
            try:
                recording = read(path)
            except RawFileError as error:
                message = error.message
            if recording is None:
                assert re.fullmatch(rf"{re.escape(str(path))}: line \d+, column \d+: .+", message)
            else:
                assert np.all(np.isfinite(recording.values))
                assert np.all(np.diff(recording.time) >= 0)
                assert len(recording.time) == len(recording.values) > 0
