"""The file of tokens: made private where there is none, refused where others may read it or it says nothing."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from doormill_ros.operator.access.token import Holder, Role
from doormill_ros.operator.access.token_file import load_keys
from doormill_ros.operator.errors import TokenFileError

OPERATE, ENGINEER = "o" * 20, "e" * 20


def write(path: Path, content: bytes, mode: int = 0o600) -> Path:
    path.write_bytes(content)
    path.chmod(mode)
    return path


def test_a_file_is_made_once_and_nobody_else_reads_it(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        keys = load_keys(tmp_path / "tokens.yaml")
    finally:
        os.umask(before)
    assert (tmp_path / "tokens.yaml").stat().st_mode & 0o777 == 0o600
    assert keys.holder(f"Bearer {keys.operate}") == Holder(Role.OPERATE)
    assert keys.holder(f"Bearer {keys.engineer}") == Holder(Role.ENGINEER)
    assert load_keys(tmp_path / "tokens.yaml") == keys
    assert load_keys(tmp_path / "other.yaml") != keys


@pytest.mark.parametrize("role", ["operate", "engineer"])
def test_a_role_without_a_line_is_nobodys(tmp_path: Path, role: str) -> None:
    keys = load_keys(write(tmp_path / "tokens.yaml", f"{role}: {OPERATE}\n".encode()))
    assert keys.holder(f"Bearer {OPERATE}") == Holder(Role[role.upper()])
    assert [keys.operate, keys.engineer].count(None) == 1


def test_people_have_tokens_of_their_own_beside_a_roles(tmp_path: Path) -> None:
    text = f"operate:\n  Kari: {OPERATE}\n  Per Ole: {'p' * 16}\nengineer: {ENGINEER}\n"
    keys = load_keys(write(tmp_path / "tokens.yaml", text.encode()))
    assert [keys.holder(f"Bearer {token}") for token in (OPERATE, "p" * 16, ENGINEER, "q" * 16)] == [
        Holder(Role.OPERATE, "Kari"),
        Holder(Role.OPERATE, "Per Ole"),
        Holder(Role.ENGINEER),
        None,
    ]
    assert OPERATE not in repr(keys)


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620])
def test_a_file_that_others_may_open_is_refused(tmp_path: Path, mode: int) -> None:
    path = write(tmp_path / "tokens.yaml", f"operate: {OPERATE}\n".encode(), mode)
    with pytest.raises(TokenFileError, match=f"has mode {mode:o}, allowed are 600 and 400") as caught:
        load_keys(path)
    assert caught.value.code == 882
    assert "remove it" in caught.value.message


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\0",
        b"\xff\xfe",
        b"- a\n",
        b"{" * 5000,
        b"operate: " + b"o" * 20_000,
        b"operate: 12345678901234567890\n",
        b"operate: short\n",
        b"operate: 'with blanks and a lot more'\n",
        b"operate: [" + OPERATE.encode() + b"]\n",
        f"operate: {OPERATE}\nengineer: {OPERATE}\n".encode(),
        f"operate: {OPERATE}\noperate: {ENGINEER}\n".encode(),
        f"operate: {OPERATE}\nadmin: {ENGINEER}\n".encode(),
        f"operate: {OPERATE}\nengineer: {{Kari: {OPERATE}}}\n".encode(),
        f"operate: {{Kari: {OPERATE}, Per: {OPERATE}}}\n".encode(),
        f"operate: {{Kari: 12345678901234567890}}\nengineer: {OPERATE}\n".encode(),
        f"operate: {{'': {OPERATE}}}\n".encode(),
        f"operate: {{1: {OPERATE}}}\n".encode(),
        f'operate: {{"a\\nb": {OPERATE}}}\n'.encode(),
        f"operate: {{{'k' * 41}: {OPERATE}}}\n".encode(),
        f"operate: {{}}\nengineer: {OPERATE}\n".encode(),
        f"admin: {{Kari: {OPERATE}}}\nengineer: {ENGINEER}\n".encode(),
        f"operate: !!python/name:os.system {OPERATE}\n".encode(),
    ],
)
def test_what_holds_no_tokens_is_refused_and_not_quoted(tmp_path: Path, content: bytes) -> None:
    path = write(tmp_path / "tokens.yaml", content)
    with pytest.raises(TokenFileError, match="operate and engineer") as caught:
        load_keys(path)
    assert OPERATE not in str(caught.value)
    assert ENGINEER not in str(caught.value)
    assert caught.value.__cause__ is None
    assert path.read_bytes() == content


def test_what_is_no_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(TokenFileError, match="is not a regular file"):
        load_keys(tmp_path)
    with pytest.raises(TokenFileError, match="neither read nor made: No such file"):
        load_keys(tmp_path / "no" / "tokens.yaml")
