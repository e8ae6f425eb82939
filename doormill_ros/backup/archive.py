"""The file of a backup: a tar archive that begins with what it is and ends with a checksum of every file in it."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import re
import secrets
import stat
import tarfile
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO, Any

from doormill_ros.backup.errors import (
    BackupEntryError,
    BackupError,
    BackupFileError,
    NewerBackupError,
    TornBackupError,
    advice_on,
)
from doormill_ros.resources import ACCEPTED, AUDIT, CONFIG, MODELS

SCHEMA = 2  #: of the archive, since it holds the audit log; whoever changes its form counts it up
FIRST, LAST = "doormill-backup.json", "manifest.json"
PARTS = (CONFIG, MODELS, ACCEPTED, AUDIT)  #: folders of a site that a backup holds
DATABASE = "database"
LONGEST_TEXT = 64 << 20  # bytes; of the first and the last file
BLOCK = 1 << 20  # bytes
FORGOTTEN = 86_400.0  # s


@dataclass(frozen=True)
class BackupHead:
    """What a backup says of itself.

    Attributes:
        release: Version of the package that wrote it.
        made: When, ISO 8601 in UTC.
        database: "sqlite" or "postgresql"; empty without a database.
        revision: Schema of that database.
    """

    release: str
    made: str
    database: str = ""
    revision: str = ""


class _Digested:
    """A stream that is read to the end exactly once; gives its checksum."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._sum = hashlib.sha256()

    def read(self, size: int = -1) -> bytes:
        data = self._stream.read(size)
        self._sum.update(data)
        return data

    def hexdigest(self) -> str:
        return self._sum.hexdigest()


def write_archive(path: Path, head: BackupHead, entries: Iterable[tuple[str, Path]]) -> None:
    """Write a backup at once: whoever reads `path` finds a whole one or none.

    Args:
        path: Must not exist; its folder does.
        head: What it says of itself.
        entries: Name in the archive, and the file on disk.

    Raises:
        BackupFileError: It cannot be written, or a file cannot be read or changes meanwhile.
    """
    if path.exists():
        raise BackupFileError(f"{path} is there already; name another file, or move that one away")
    beside = path.with_name(f".{path.name}.{secrets.token_hex(6)}.part")
    try:
        handle = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(handle, "wb") as stream:
            _fill(stream, head, entries)
            stream.flush()
            os.fsync(stream.fileno())
        read_archive(beside)
        os.replace(beside, path)
    except OSError as error:
        raise BackupFileError(f"the backup {path} cannot be written: {error}; {advice_on(error)}") from error
    finally:
        beside.unlink(missing_ok=True)


def sweep_parts(path: Path) -> None:
    """Delete what killed backups left beside a file: of this name, and of others when nobody wrote to it for a day."""
    for left in path.parent.glob(".*.part"):
        part = re.fullmatch(r"\.(.+)\.[0-9a-f]{12}\.part", left.name)
        with contextlib.suppress(OSError):
            if part and (part[1] == path.name or time.time() - left.stat().st_mtime > FORGOTTEN):
                left.unlink()


def _fill(stream: IO[bytes], head: BackupHead, entries: Iterable[tuple[str, Path]]) -> None:
    files: dict[str, dict[str, Any]] = {}
    with tarfile.open(fileobj=stream, mode="w", format=tarfile.PAX_FORMAT) as archive:

        def add(name: str, source: IO[bytes], size: int, mode: int = 0o644) -> None:
            member = tarfile.TarInfo(name)
            member.size, member.mode = size, stat.S_IMODE(mode)
            digested = _Digested(source)
            archive.addfile(member, digested)
            files[name] = {"size": size, "sha256": digested.hexdigest()}

        def add_text(name: str, document: dict[str, Any]) -> None:
            data = (json.dumps(document, indent=1) + "\n").encode()
            add(name, io.BytesIO(data), len(data))

        add_text(FIRST, {"schema": f"doormill/backup/{SCHEMA}", **asdict(head)})
        for name, path in entries:
            try:
                with path.open("rb") as source:
                    found = os.fstat(source.fileno())
                    add(name, source, found.st_size, found.st_mode)
                    if source.read(1):
                        raise OSError("it grew")
            except OSError as error:
                raise BackupFileError(
                    f"{path} cannot be read, or changes while it is: {error}; try again when nobody writes there"
                ) from error
        add_text(LAST, {"files": dict(files)})


@dataclass(frozen=True)
class Backup:
    """A backup that was read to its end and found whole.

    Attributes:
        path: The file.
        head: What it says of itself.
        digests: SHA-256 of every file in it, by name.
    """

    path: Path
    head: BackupHead
    digests: dict[str, str]

    def extract(self, folder: Path) -> None:
        """Write every file but the first and the last below a folder, which must be empty.

        Raises:
            TornBackupError: The archive was changed since it was read.
            BackupFileError: A file cannot be written.
        """
        with _opened(self.path) as members:
            for name, mode, stream in members:
                digested = _Digested(stream)
                try:
                    if name in (FIRST, LAST):
                        digested.read()
                    else:
                        _copy(digested, folder / name, mode)
                except OSError as error:
                    raise BackupFileError(
                        f"{folder / name} cannot be written: {error}; {advice_on(error)}"
                    ) from error
                if name != LAST and self.digests.get(name) != digested.hexdigest():
                    raise TornBackupError(f"the backup {self.path} was changed while it was read; try again")


def _copy(source: _Digested, target: Path, mode: int) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    # Nobody else reads it before it is for whom it was.
    with os.fdopen(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as stream:
        while block := source.read(BLOCK):
            stream.write(block)
        os.fchmod(stream.fileno(), mode & 0o777)
        stream.flush()
        os.fsync(stream.fileno())


def read_archive(path: Path) -> Backup:
    """Read a backup to its end and write nothing.

    Raises:
        BackupFileError: No such file.
        TornBackupError: Cut short, damaged, or no backup.
        NewerBackupError: Of a later release.
        BackupEntryError: It holds names or kinds of files that no backup has.
    """
    head: BackupHead | None = None
    found: dict[str, tuple[int, str]] = {}
    manifest: dict[str, Any] | None = None
    with _opened(path) as members:
        for name, _, stream in members:
            if manifest is not None:
                raise _torn(path, f"{name} comes after its end")
            if name in found:
                raise _entry(path, name, "it is there twice")
            digested, size, text = _Digested(stream), 0, b""
            while block := digested.read(BLOCK):
                size += len(block)
                if name in (FIRST, LAST):
                    text += block
                    if size > LONGEST_TEXT:
                        raise _torn(path, f"{name} is larger than {LONGEST_TEXT} bytes")
            if head is None:
                if name != FIRST:
                    raise _torn(path, f"it begins with {name} instead of {FIRST}")
                head = _head(path, _document(path, name, text))
            if name == LAST:
                manifest = _document(path, name, text)
            else:
                found[name] = (size, digested.hexdigest())
    if head is None or manifest is None:
        raise _torn(path, "its end is missing")
    if manifest.get("files") != {name: {"size": size, "sha256": sha} for name, (size, sha) in found.items()}:
        raise _torn(path, "a checksum in it is not that of its file")
    return Backup(path, head, {name: sha for name, (_, sha) in found.items()})


@contextmanager
def _opened(path: Path) -> Iterator[Iterator[tuple[str, int, IO[bytes]]]]:
    """The files of an archive in turn, with their modes; what is no plain file under a proper name is refused."""

    def members(archive: tarfile.TarFile) -> Iterator[tuple[str, int, IO[bytes]]]:
        for member in archive:
            name = member.name
            if not member.isreg() or member.issparse():
                raise _entry(path, name, "it is no plain file")
            if name not in (FIRST, LAST) and not _proper(name):
                raise _entry(path, name, f"allowed are files below {', '.join((DATABASE, *PARTS))}")
            stream = archive.extractfile(member)
            assert stream is not None  # only a file without content, such as a folder, has none
            yield name, member.mode, stream
        _complete(path, archive)

    try:
        with path.open("rb") as file, tarfile.open(fileobj=file, mode="r:") as archive:
            yield members(archive)
    except BackupError:
        raise
    except FileNotFoundError as error:
        raise BackupFileError(f"there is no backup {path}; name the file that `backup` wrote") from error
    except Exception as error:  # the library raises many kinds for a damaged file
        raise _torn(path, str(error) or type(error).__name__) from error


def _complete(path: Path, archive: tarfile.TarFile) -> None:
    """Behind the last file there is nothing but zeros: the library takes a damaged header for the end."""
    file = archive.fileobj
    assert file is not None
    file.seek(archive.offset)
    while block := file.read(BLOCK):
        if block.strip(b"\0"):
            raise _torn(path, "something in it is no file of an archive")


def _proper(name: str) -> bool:
    parts = name.split("/")
    inside = len(parts) > 1 and parts[0] in (DATABASE, *PARTS)
    return inside and "\0" not in name and not {"", ".", ".."} & set(parts)


def _document(path: Path, name: str, text: bytes) -> dict[str, Any]:
    document = json.loads(text)
    if not isinstance(document, dict):
        raise _torn(path, f"{name} holds no list of names and values")
    return document


def _head(path: Path, document: dict[str, Any]) -> BackupHead:
    schema = re.fullmatch(r"doormill/backup/(\d{1,9})", str(document.pop("schema", "")))
    if schema is None:
        raise _torn(path, f"{FIRST} does not say that it is a backup")
    if int(schema[1]) > SCHEMA:
        raise NewerBackupError(
            f"the backup {path} has form {schema[1]}, written by release {document.get('release')!r}; allowed is up to "
            f"{SCHEMA}; restore it with that release",
            found=schema[1],
        )
    head = BackupHead(**document)
    if not all(isinstance(value, str) for value in asdict(head).values()):
        raise _torn(path, f"{FIRST} holds a value that is no text")
    return head


def _torn(path: Path, why: str) -> BackupError:
    return TornBackupError(f"{path} is no whole backup: {why}; take another copy of it")


def _entry(path: Path, name: str, why: str) -> BackupError:
    return BackupEntryError(f"the backup {path} holds {name!r}: {why}; nothing of it was restored", name=name)
