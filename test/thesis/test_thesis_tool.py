"""The tool `thesis` says what the older options of other tools say, and what contradicts what."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.tools import diagnose, identify, thesis


@pytest.mark.parametrize(("command", "tool"), [("identify", identify), ("diagnose", diagnose)])
def test_a_command_writes_what_the_option_writes(command, tool, tmp_path: Path, capsys) -> None:
    new, old = tmp_path / "new", tmp_path / "old"
    assert thesis.main([command, "--out", str(new)]) == 0
    said = capsys.readouterr().out
    assert tool.main(["--thesis", "--out", str(old)]) == 0
    assert said == capsys.readouterr().out.replace(str(old), str(new))
    names = sorted(path.name for path in new.iterdir())
    assert len(names) >= 2
    assert names == sorted(path.name for path in old.iterdir())
    assert [(new / name).read_bytes() for name in names] == [(old / name).read_bytes() for name in names]


def test_contradictions_are_printed_one_a_line(capsys) -> None:
    assert thesis.main(["contradictions"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 18
    assert all(line.startswith("- ") for line in lines)
    assert any("torque of joint 1 in test 6 (A.13 against equation 2.34)" in line for line in lines)


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path, capsys) -> None:
    (tmp_path / "file").write_text("")
    assert thesis.main(["identify", "--out", str(tmp_path / "file")]) == 2
    assert "thesis:" in capsys.readouterr().err
