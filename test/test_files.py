"""A file is replaced in one step: the old content or the new one, and no rest beside it."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from doormill_ros.files import ReadBackError, is_same, write_atomically, write_together
from support.full_disk import room_for


def test_text_and_bytes_replace_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_atomically(path, "öld\n")
    assert path.read_bytes() == "öld\n".encode()
    write_atomically(path, b"new", durable=True, verify=True)
    assert path.read_bytes() == b"new"
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


def test_a_link_stays_and_the_mode_too(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there" / "a.yaml", tmp_path / "a.yaml"
    target.write_text("old")
    target.chmod(0o664)
    link.symlink_to(target)
    write_atomically(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert target.stat().st_mode & 0o777 == 0o664
    assert [p.name for p in target.parent.iterdir()] == ["a.yaml"]


def test_a_folder_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OSError, match=r"a folder, allowed is the name of a file: '\.'"):
        write_atomically(Path("."), "new")


def test_names_of_one_file_are_known(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("a")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    assert is_same(tmp_path / "a", tmp_path / "b")
    assert is_same(tmp_path / "new", tmp_path / "." / "new")
    assert not is_same(tmp_path / "a", tmp_path / "new")


def test_a_failed_rename_keeps_the_old_content_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.json"
    write_atomically(path, "old")
    beside: list[str] = []

    def full(source: Path, _target: Path) -> None:
        beside.append(source.name)
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space left"):
        write_atomically(path, "new", suffix=".mine")
    assert len(beside) == 1
    assert beside[0].startswith(".a.json.")
    assert beside[0].endswith(".mine")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]


def test_a_file_cut_short_is_noticed_before_the_rename(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.txt"
    real = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda self: real(self)[:2])
    with pytest.raises(ReadBackError, match="2 bytes and first differs at byte 2") as caught:
        write_atomically(path, "1234", verify=True)
    assert (caught.value.size, caught.value.found, caught.value.position) == (4, 2, 2)
    assert not path.exists()


def test_of_files_that_belong_together_all_are_written_before_one_is_replaced(tmp_path: Path) -> None:
    first, second, gone = (tmp_path / name for name in ("a", "b", "c"))
    for path in (first, gone):
        path.write_text("old")
    with room_for(10), pytest.raises(OSError, match="too large"):
        write_together({first: "new", second: "longer than that"}, gone=[gone])
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "old", "c": "old"}
    second.mkdir()
    with pytest.raises(IsADirectoryError):
        write_together({first: "new", second: "new"}, gone=[gone])
    assert (first.read_text(), gone.read_text(), len(list(tmp_path.iterdir()))) == ("old", "old", 3)
    second.rmdir()
    write_together({first: "new", second: b"new"}, gone=[gone])
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "new", "b": "new"}
