"""What the disk refuses is told with what helps against it."""

from __future__ import annotations

import errno
import io
import json
import subprocess
import sys
import tarfile
from hashlib import sha256
from pathlib import Path

import pytest

from doormill_ros.backup.archive import FIRST, LAST, SCHEMA, read_archive
from doormill_ros.backup.errors import advice_on
from doormill_ros.tools import restore as restore_tool
from support.waiting import LIMIT


def archive(path: Path, names: list[str]) -> Path:
    """A whole backup with files of these names."""
    head = {"schema": f"doormill/backup/{SCHEMA}", "release": "0", "made": "", "database": "", "revision": ""}
    content = {FIRST: json.dumps(head).encode(), **dict.fromkeys(names, b"x")}
    listed = {name: {"size": len(data), "sha256": sha256(data).hexdigest()} for name, data in content.items()}
    content[LAST] = json.dumps({"files": listed}).encode()
    with tarfile.open(path, "w", format=tarfile.PAX_FORMAT) as tar:
        for name, data in content.items():
            member = tarfile.TarInfo(name)
            member.size = len(data)
            tar.addfile(member, io.BytesIO(data))
    return path


@pytest.mark.parametrize(
    "names", [["config/" + "x" * 300], ["config/a", "config/a/b"], ["config/a/b", "config/a"]]
)
def test_names_that_fit_no_folder_ask_nobody_to_free_the_disk(
    tmp_path: Path, names: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    path = archive(tmp_path / "b.tar", names)
    assert read_archive(path).head.release == "0"
    assert restore_tool.main([str(path), "--site", str(tmp_path / "site")]) == 2
    said = capsys.readouterr().err
    assert "free the disk" not in said
    assert "no backup of a site has such names" in said


def test_a_limit_on_the_size_of_files_is_named(site: Path, tmp_path: Path) -> None:
    script = f"ulimit -f 8; {sys.executable} -m doormill_ros.tools.backup {tmp_path / 'b.tar'} --site {site}"
    ended = subprocess.run(["bash", "-c", script], capture_output=True, text=True, timeout=LIMIT, check=False)
    assert ended.returncode == 2
    assert "ulimit -f" in ended.stderr
    assert "stop the cells" not in ended.stderr


@pytest.mark.parametrize(
    ("number", "advice"),
    [
        (errno.ENOSPC, "free the disk"),
        (errno.EDQUOT, "free the disk"),
        (errno.EFBIG, "ulimit -f"),
        (errno.EACCES, "written by this user"),
        (errno.EIO, "look at the disk"),
    ],
)
def test_each_refusal_has_its_advice(number: int, advice: str) -> None:
    assert advice in advice_on(OSError(number, "no"))
