"""The tool that a target file says: written, read back, left out in earlier files, refused where it is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.abb.errors import TargetLineError, TargetProgramError
from doormill_ros.abb.target_file.checksum import checksum
from doormill_ros.abb.target_file.target_file import (
    read_target_file,
    render_target_file,
    says_tool,
    without_tool,
)
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import rotation_rpy, transform

TILTED = transform(rotation_rpy([0.1, -0.7, 2.0]), np.array([0.0123456, -0.2, 0.2503]))


@pytest.fixture(scope="module")
def program(door):
    return door("thesis_190_0deg")


def test_a_generated_program_says_the_cells_tool(program):
    data = render_target_file(program, "run")
    assert b"\n#tool [[0,0,250],[1,0,0,0]]\n" in data
    assert np.allclose(read_target_file(data).tool, load_layout().T_flange_tool, atol=1e-12)


@pytest.mark.parametrize("T", [TILTED, np.eye(4), transform(rotation_rpy([np.pi, 0.0, 0.0]))])
def test_any_tool_is_read_back(program, T):
    tool = read_target_file(render_target_file(replace(program, tool=T), "run")).tool
    assert np.abs(tool[:3, 3] - T[:3, 3]).max() <= 0.5e-6 + 1e-12
    assert np.abs(tool[:3, :3] - T[:3, :3]).max() < 3e-6


def test_earlier_files_do_not_say_it(program):
    data = render_target_file(program, "run")
    plain = without_tool(data)
    assert (says_tool(data), says_tool(plain)) == (True, False)
    assert plain == render_target_file(replace(program, tool=None), "run")
    assert read_target_file(plain).tool is None


@pytest.mark.parametrize(
    "text", ["[0,0,250]", "[[0,0,250],[0.9,0,0,0]]", "[[0,0,1e3],[1,0,0,0]]", "[[0,0,250],[1,0,0]]", "tool0"]
)
def test_what_is_no_tool_is_refused(program, text):
    lines = render_target_file(program, "run").decode().splitlines()[:-1]
    lines = [f"#tool {text}" if line.startswith("#tool ") else line for line in lines]
    a, b = checksum(lines)
    data = "".join(f"{line}\n" for line in [*lines, f"#sum [{a},{b}]"]).encode()
    with pytest.raises(TargetLineError, match="a place and a unit quaternion"):
        read_target_file(data)


@pytest.mark.parametrize(
    "T", [np.eye(3), transform(translation=np.array([0.0, 0.0, 10.0])), np.full((4, 4), np.nan)]
)
def test_a_tool_that_cannot_be_written_is_named(program, T):
    with pytest.raises(TargetProgramError, match=r"correct tool\.position"):
        render_target_file(replace(program, tool=T), "run")
