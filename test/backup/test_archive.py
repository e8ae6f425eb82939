"""The file of a backup: whole or refused, and nothing in it leads out of the folder it is restored into."""

from __future__ import annotations

import hashlib
import io
import json
import random
import tarfile
from pathlib import Path

import pytest

from doormill_ros.backup.archive import BackupHead, read_archive, write_archive
from doormill_ros.backup.errors import (
    BackupEntryError,
    BackupError,
    BackupFileError,
    NewerBackupError,
    TornBackupError,
)

HEAD = BackupHead("0.1.0", "2026-11-22T12:00:00+00:00")
GOOD = {
    "config/camera.yaml": b"K: 1\n",
    "models/a/model.yaml": b"",
    "accepted/b.mcap": bytes(range(256)) * 9,
} | {"audit/orders.jsonl": b"{}\n"}


@pytest.fixture
def written(tmp_path: Path) -> Path:
    entries = []
    for name, data in GOOD.items():
        path = tmp_path / "from" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        entries.append((name, path))
    write_archive(tmp_path / "b.tar", HEAD, entries)
    return tmp_path / "b.tar"


def forged(
    path: Path, members: list[tuple[tarfile.TarInfo, bytes]], schema: str = "doormill/backup/1"
) -> Path:
    """An archive that says of itself that it is whole, made without the code under test."""
    head = json.dumps({"schema": schema, "release": "9.9", "made": "now"}).encode()
    members = [(tarfile.TarInfo("doormill-backup.json"), head), *members]
    sums = {m.name: {"size": len(data), "sha256": hashlib.sha256(data).hexdigest()} for m, data in members}
    members = [*members, (tarfile.TarInfo("manifest.json"), json.dumps({"files": sums}).encode())]
    with tarfile.open(path, "w") as archive:
        for member, data in members:
            member.size = len(data)
            archive.addfile(member, io.BytesIO(data))
    return path


def entry(name: str, kind: bytes = tarfile.REGTYPE, target: str = "") -> tarfile.TarInfo:
    member = tarfile.TarInfo(name)
    member.type, member.linkname = kind, target
    return member


def files_below(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_what_went_in_comes_out(written: Path, tmp_path: Path) -> None:
    backup = read_archive(written)
    (tmp_path / "to").mkdir()
    backup.extract(tmp_path / "to")
    assert files_below(tmp_path / "to") == GOOD
    assert backup.head == HEAD
    assert written.stat().st_mode & 0o077 == 0, "recipes are nobody else's business"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["b.tar", "from", "to"]


def test_a_plain_tar_reads_it(written: Path) -> None:
    with tarfile.open(written) as archive:
        assert set(GOOD) < set(archive.getnames())


def test_a_forged_archive_of_good_names_is_read(tmp_path: Path) -> None:
    """So that the refusals below are refusals of what is wrong."""
    backup = read_archive(forged(tmp_path / "b.tar", [(entry("models/a.yaml"), b"x")]))
    assert backup.head.release == "9.9"


@pytest.mark.parametrize(
    "name",
    [
        "../evil",
        "/etc/evil",
        "config/../../evil",
        "config//evil",
        "config/./evil",
        "config",
        "recipes.sqlite",
        "replaced/evil",
        ".restore/begun.json",
        "config/a\\..\\..\\b/../c",
    ],
)
def test_names_that_lead_elsewhere_are_refused(tmp_path: Path, name: str) -> None:
    path = forged(tmp_path / "b.tar", [(entry("models/fine"), b"x"), (entry(name), b"evil")])
    with pytest.raises(BackupEntryError, match="nothing of it was restored"):
        read_archive(path)


@pytest.mark.parametrize(
    ("kind", "target"),
    [
        (tarfile.SYMTYPE, "/etc"),
        (tarfile.LNKTYPE, "models/fine"),
        (tarfile.CHRTYPE, ""),
        (tarfile.FIFOTYPE, ""),
        (tarfile.DIRTYPE, ""),
    ],
)
def test_what_is_no_plain_file_is_refused(tmp_path: Path, kind: bytes, target: str) -> None:
    path = forged(
        tmp_path / "b.tar", [(entry("models/fine"), b""), (entry("config/link", kind, target), b"")]
    )
    with pytest.raises(BackupEntryError, match="no plain file"):
        read_archive(path)


def test_a_name_that_is_there_twice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BackupEntryError, match="twice"):
        read_archive(forged(tmp_path / "b.tar", [(entry("models/a"), b"1"), (entry("models/a"), b"1")]))


def test_a_backup_of_a_later_form_is_left_alone(tmp_path: Path) -> None:
    with pytest.raises(NewerBackupError, match=r"release '9\.9'.*allowed is up to 2"):
        read_archive(forged(tmp_path / "b.tar", [(entry("models/a"), b"1")], "doormill/backup/3"))


def test_one_cut_anywhere_is_refused_or_whole(written: Path, tmp_path: Path) -> None:
    """An archive ends in zeros; only those may be missing."""
    content = written.read_bytes()
    needed = len(content.rstrip(b"\0"))
    cut = tmp_path / "cut.tar"
    for size in (*range(0, needed, 97), needed - 1):
        cut.write_bytes(content[:size])
        with pytest.raises(TornBackupError):
            read_archive(cut)


def test_one_flipped_anywhere_is_refused_or_says_the_same(written: Path, tmp_path: Path) -> None:
    content = written.read_bytes()
    generator = random.Random(5)
    refused = 0
    for _ in range(300):
        damaged = bytearray(content)
        damaged[generator.randrange(len(content.rstrip(b"\0")))] ^= 1 << generator.randrange(8)
        (tmp_path / "d.tar").write_bytes(damaged)
        try:
            backup = read_archive(tmp_path / "d.tar")
        except BackupError:
            refused += 1
            continue
        # Zeros between the files, which nobody reads.
        folder = tmp_path / f"to-{refused}-{generator.random()}"
        folder.mkdir()
        backup.extract(folder)
        assert files_below(folder) == GOOD
        assert backup.head == HEAD
    assert refused > 150


def test_no_archive_at_all_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("hello " * 1000)
    with pytest.raises(TornBackupError):
        read_archive(tmp_path / "text")
    with pytest.raises(BackupFileError, match="there is no backup"):
        read_archive(tmp_path / "nowhere")


def test_a_backup_that_is_there_is_not_overwritten(written: Path) -> None:
    before = written.read_bytes()
    with pytest.raises(BackupFileError, match="is there already"):
        write_archive(written, HEAD, [])
    assert written.read_bytes() == before


def test_a_file_that_cannot_be_read_leaves_no_backup(tmp_path: Path) -> None:
    with pytest.raises(BackupFileError, match="gone"):
        write_archive(tmp_path / "b.tar", HEAD, [("models/a", tmp_path / "gone")])
    assert list(tmp_path.iterdir()) == []
