"""Files below HOME: and reading them line by line."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import BinaryIO

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.predefined_data import END_OF_FILE
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import STRING_LENGTH, is_integer


class Device:
    """An open file."""

    def __init__(self, stream: BinaryIO, readable: bool) -> None:
        """Take the open stream."""
        self.stream = stream
        self.readable = readable

    def read_string(self, delimiters: bytes) -> str:
        """Up to 80 characters, to a delimiter, which is read and dropped; EOF at the end.

        When 80 characters come before the delimiter, the next call goes on with the rest of the
        line: so it is a longer line that shifts all that follow it.
        """
        text = bytearray()
        while len(text) < STRING_LENGTH:
            byte = self.stream.read(1)
            if not byte:
                return text.decode("latin-1") if text else END_OF_FILE
            if byte in delimiters:
                return text.decode("latin-1")
            text += byte
        # The delimiter straight after 80 characters: whether it is taken along is not documented.
        # Leaving it is the harsher reading, under which the next call gives an empty string.
        return text.decode("latin-1")

    def skip_to_line(self, number: int) -> None:
        """Go to the start of a line, counted from 1 from the start of the file."""
        self.stream.seek(0)
        for _ in range(number - 1):
            if not self.stream.readline():
                break


def find_path(context: Context, name: str, file: str | None = None) -> Path:
    """The path behind `HOME:name`, or `HOME:` and a file name.

    Raises:
        RapidFault: ERR_FILEACC for anything outside HOME:.
    """
    device, colon, rest = name.partition(":")
    full = "/".join(part for part in (rest.strip("/"), (file or "").strip("/")) if part)
    parts = Path(full).parts
    if not colon or device.upper() != "HOME" or not parts or ".." in parts or "\0" in full:
        raise RapidFault("ERR_FILEACC", f"{name!r} is no file below HOME:")
    return context.machine.home.joinpath(*parts)


def opened(place: Reference, what: str) -> Device:
    """The open file in an iodev.

    Raises:
        RapidFault: ERR_FILEACC when it is not open.
    """
    device = place[0][place[1]]
    if not isinstance(device, Device):
        raise RapidFault("ERR_FILEACC", f"{what}: the file is not open")
    return device


@predefined(
    "PROC Open(string Object \\string File, VAR iodev IODevice "
    "\\switch Read | switch Write | switch Append \\switch Bin)"
)
def open_file(
    context: Context,
    name: str,
    file: str | None,
    place: Reference,
    read: bool,
    _write: bool,
    append: bool,
    _binary: bool,
) -> None:
    """Open a file; without a switch it is written."""
    if isinstance(place[0][place[1]], Device):
        raise RapidFault("ERR_FILEOPEN", f"Open {name!r}: the iodev is open already")
    path = find_path(context, name, file)
    try:
        stream = open(path, "rb" if read else "ab" if append else "wb")  # noqa: SIM115
    except OSError as error:
        raise RapidFault("ERR_FILEOPEN", f"{path.name} cannot be opened: {error.strerror}") from None
    device = Device(stream, read)
    place[0][place[1]] = device
    context.devices.append(device)


@predefined("PROC Close(VAR iodev IODevice)")
def close_file(context: Context, place: Reference) -> None:
    """Close a file; one that is not open is taken for an error, the harsher of two readings."""
    device = opened(place, "Close")
    device.stream.close()
    place[0][place[1]] = None
    context.devices.remove(device)


@predefined(
    "FUNC string ReadStr(VAR iodev IODevice \\string Delim \\switch RemoveCR \\switch DiscardHeaders "
    "\\num Time \\num Line)"
)
def read_str(
    _context: Context,
    place: Reference,
    delimiters: str | None,
    remove_cr: bool,
    discard_headers: bool,
    _time: float | None,
    line: float | None,
) -> str:
    r"""Read a line without its end; `\Line` is the thesis' own and counts from the file's start."""
    device = opened(place, "ReadStr")
    if not device.readable:
        raise RapidFault("ERR_FILEACC", "ReadStr: the file is open for writing")
    if line is not None:
        if not is_integer(line) or line < 1:
            raise RapidFault("ERR_ARGVALERR", f"ReadStr: line {line:g}, allowed is 1 and more")
        device.skip_to_line(int(line))
    ends = b"\n" + (delimiters or "").encode("latin-1")
    try:
        text = device.read_string(ends)
        while discard_headers and text == "":
            text = device.read_string(ends)
    except OSError as error:
        raise RapidFault("ERR_FILEACC", f"ReadStr: {error.strerror}") from None
    return text.removesuffix("\r") if remove_cr else text


@predefined("PROC Write(VAR iodev IODevice, string String \\switch NoNewLine)")
def write(_context: Context, place: Reference, text: str, no_new_line: bool) -> None:
    """Write a line."""
    device = opened(place, "Write")
    try:
        device.stream.write(text.encode("latin-1") + (b"" if no_new_line else b"\n"))
        device.stream.flush()
    except OSError as error:
        raise RapidFault("ERR_FILEACC", f"Write: {error.strerror or error}") from None


@predefined("PROC Rewind(VAR iodev IODevice)")
def rewind(_context: Context, place: Reference) -> None:
    """Go to the start of a file."""
    opened(place, "Rewind").stream.seek(0)


@predefined("FUNC bool IsFile(string Path)")
def is_file(context: Context, name: str) -> bool:
    """Whether a file exists."""
    return find_path(context, name).is_file()


@predefined("PROC CopyFile(string OldPath, string NewPath)")
def copy_file(context: Context, old: str, new: str) -> None:
    """Copy a file; a file of the new name is not replaced."""
    source, target = _old_and_new(context, "CopyFile", old, new)
    try:
        shutil.copyfile(source, target)
    except OSError as error:
        raise RapidFault("ERR_FILEACC", f"CopyFile {old!r}: {error.strerror}") from None


@predefined("PROC RenameFile(string OldPath, string NewPath)")
def rename_file(context: Context, old: str, new: str) -> None:
    """Rename a file; a file of the new name is not replaced."""
    source, target = _old_and_new(context, "RenameFile", old, new)
    try:
        source.rename(target)
    except OSError as error:
        raise RapidFault("ERR_FILEACC", f"RenameFile {old!r}: {error.strerror}") from None


def _old_and_new(context: Context, what: str, old: str, new: str) -> tuple[Path, Path]:
    source, target = find_path(context, old), find_path(context, new)
    if not source.is_file():
        raise RapidFault("ERR_FILEACC", f"{what} {old!r}: no such file")
    if target.exists():
        raise RapidFault("ERR_FILEEXIST", f"{what}: {new!r} exists")
    return source, target


@predefined("FUNC num FileSize(string Path)")
def file_size(context: Context, name: str) -> float:
    """Size in bytes."""
    try:
        return float(os.path.getsize(find_path(context, name)))
    except OSError as error:
        raise RapidFault("ERR_FILEACC", f"FileSize {name!r}: {error.strerror}") from None


@predefined("PROC RemoveFile(string Path)")
def remove_file(context: Context, name: str) -> None:
    """Remove a file."""
    try:
        find_path(context, name).unlink()
    except OSError as error:
        raise RapidFault("ERR_FILEACC", f"RemoveFile {name!r}: {error.strerror}") from None
