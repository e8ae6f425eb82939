"""Read a file of text, and replace one in one step: a reader finds the old content or the new one, nothing between."""

from __future__ import annotations

import codecs
import contextlib
import errno
import os
import secrets
import stat
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path


class ReadBackError(OSError):
    """A file that holds something else than what was just written into it.

    Attributes:
        path: The file that was read back.
        size: Bytes written.
        found: Bytes read back.
        position: First byte that differs.
    """

    def __init__(self, path: Path, data: bytes, found: bytes) -> None:
        """Compare what was written with what was found."""
        pairs = enumerate(zip(found, data, strict=False))
        self.position = next((i for i, (a, b) in pairs if a != b), min(len(found), len(data)))
        self.path, self.size, self.found = path, len(data), len(found)
        super().__init__(
            f"{path} reads back with {self.found} bytes and first differs at byte {self.position}, "
            f"written were {self.size} bytes: check that nothing else writes there, and the disk"
        )


class NotPrivateError(OSError):
    """A file of secrets that is no file, that others may read, or that is somebody else's.

    Attributes:
        mode: Its mode in octal digits where that is why, else empty.
    """

    def __init__(self, problem: str, mode: str = "") -> None:
        super().__init__(problem)
        self.mode = mode


class NotUtf8(ValueError):
    """A text that is no UTF-8.

    Attributes:
        where: Line and column of the first byte that is none, as "line 2, column 5".
        reason: What is wrong with it.
    """

    def __init__(self, before: bytes, reason: str) -> None:
        """Count in the good bytes before the bad one."""
        line = before[before.rfind(b"\n") + 1 :].decode("utf-8")
        self.where = f"line {before.count(10) + 1}, column {len(line) + 1}"
        self.reason = reason
        super().__init__(f"{self.where}: is no UTF-8 text ({reason})")


def text_of_utf8(content: bytes) -> str:
    """The text of bytes in UTF-8, with or without a mark at their beginning; lines end with a line feed.

    Raises:
        NotUtf8: They are none.
    """
    content = content.removeprefix(codecs.BOM_UTF8)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise NotUtf8(content[: error.start], error.reason) from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_regular(path: Path) -> bytes:
    """What a file holds; a pipe or a device, which may never end, is refused.

    Raises:
        OSError: It cannot be opened, or is no regular file; `strerror` says which.
        ValueError: No file can have that name.
    """
    mode = os.stat(path).st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise OSError(errno.EINVAL, "a pipe, a device or a socket, not a regular file", str(path))
    return path.read_bytes()


def read_utf8(path: Path) -> str:
    """The text of a regular file in UTF-8, as of `text_of_utf8`.

    Raises:
        OSError: It cannot be opened, or is no regular file.
        ValueError: It is no UTF-8 (`NotUtf8`), or no file can have that name.
    """
    return text_of_utf8(read_regular(path))


def read_private(path: Path, most: int) -> bytes:
    """What a file of secrets holds.

    Args:
        path: The file; nobody but its owner may read it, who is this user or root.
        most: Bytes that are read at most.

    Raises:
        OSError: It cannot be opened.
        NotPrivateError: It is not as described.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        # Of the open file, not of the path: nobody can exchange it between check and reading.
        status = os.fstat(descriptor)
        mode = stat.S_IMODE(status.st_mode)
        if not stat.S_ISREG(status.st_mode):
            raise NotPrivateError("is not a regular file")
        if mode & 0o077:
            raise NotPrivateError(f"has mode {mode:o}, allowed are 600 and 400", f"{mode:o}")
        if status.st_uid not in (os.geteuid(), 0):
            raise NotPrivateError(f"belongs to user {status.st_uid}, not to you or root")
        return os.read(descriptor, most)
    finally:
        os.close(descriptor)


def write_atomically(
    path: Path, content: bytes | str, *, durable: bool = False, verify: bool = False, suffix: str = ".part"
) -> None:
    """Write a file beside `path` and rename it over `path`.

    On any failure before the rename `path` keeps what it held; the file beside it is always removed. A link stays one,
    what it leads to is replaced; who may read and write the file before may do so afterwards.

    Args:
        path: File to replace or create; its folder exists.
        content: The whole new content; text is written as UTF-8.
        durable: True when the new content must survive a power cut right after the call.
        verify: True to read the content back, before the rename and after it.
        suffix: End of the name beside `path`, by which an owner of the folder knows what a killed
            writer left.

    Raises:
        OSError: The file cannot be written or renamed.
        ReadBackError: It reads back differently.
    """
    data = _bytes_of(content)
    with _written_beside(Path(path), data, suffix) as (beside, path):
        if durable:
            _flush(beside)
        if verify:
            _compare(beside, data)
        os.replace(beside, path)
        if durable:
            # Makes the rename survive, where the system can do that for a folder.
            with contextlib.suppress(OSError):
                _flush(path.parent)
        if verify:
            _compare(path, data)


def write_together(contents: Mapping[Path, bytes | str], gone: Iterable[Path] = ()) -> None:
    """Replace files that belong together: all are written beside theirs before the first of them is renamed.

    A disk that is full leaves what was there. Who must not take old and new files for one looks at the last one,
    which is renamed last: what ends the process between two renames leaves it as it was.

    Args:
        contents: The whole new content by file, in the order in which they are renamed; as of `write_atomically`.
        gone: Files that must not be there beside the new ones; removed where they are, before the first rename.

    Raises:
        OSError: One cannot be written or renamed.
    """
    with contextlib.ExitStack() as written:
        pairs = [
            written.enter_context(_written_beside(path, _bytes_of(content), ".part"))
            for path, content in contents.items()
        ]
        for _, path in pairs:
            if path.is_dir():  # found out before the first rename
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        for path in gone:
            path.unlink(missing_ok=True)
        for beside, path in pairs:
            os.replace(beside, path)


@contextlib.contextmanager
def _written_beside(path: Path, data: bytes, suffix: str) -> Iterator[tuple[Path, Path]]:
    """A new file with its content beside `path`, and what `path` leads to; the new one is gone afterwards."""
    if not path.name:
        raise IsADirectoryError(errno.EISDIR, "a folder, allowed is the name of a file", str(path))
    if path.is_symlink():
        path = Path(os.path.realpath(path))
    # A hidden name that no reader asks for; random, so that two writers never share one.
    beside = path.with_name(f".{path.name}.{secrets.token_hex(6)}{suffix}")
    try:
        beside.write_bytes(data)
        with contextlib.suppress(OSError):  # there is none, or the medium has no modes
            beside.chmod(stat.S_IMODE(path.stat().st_mode))
        yield beside, path
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)


def _bytes_of(content: bytes | str) -> bytes:
    return content.encode("utf-8") if isinstance(content, str) else content


def _compare(path: Path, data: bytes) -> None:
    """Raise unless the file holds exactly `data`."""
    found = path.read_bytes()
    if found != data:
        raise ReadBackError(path, data, found)


def _flush(path: Path) -> None:
    """Bring a file or folder onto its medium."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def is_same(one: Path, other: Path) -> bool:
    """Whether two names are of one file, which need not be there; a link is what it leads to."""
    try:
        return one.samefile(other)
    except (OSError, ValueError):
        return os.path.realpath(one) == os.path.realpath(other)


def is_file(path: Path) -> bool:
    """Whether a file is there; False, too, of a name that no file can have."""
    try:
        return path.is_file()
    except OSError:
        return False
