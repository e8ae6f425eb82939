"""The seam to the controller: signals and files, every operation bounded by a timeout.

A transport moves bits and bytes and decides nothing; the order of operations that keeps the robot
from executing a wrong file is the handshake's (`doormill_ros.abb.handshake.handshake`).
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Protocol, runtime_checkable

from doormill_ros.abb.link_errors import FileNameError


@runtime_checkable
class Transport(Protocol):
    """One controller's handshake signals and target files.

    Every method returns within the transport's timeouts or raises a `LinkError` leaf that names the
    phase. When a write or `set_ready` raises, it may or may not have been carried out, now or later:
    the caller must find out by reading, never assume.
    """

    @property
    def in_doubt_time(self) -> float:
        """Time after which an operation whose end is not known can no longer take effect [s]."""
        ...

    def read_request(self) -> bool:
        """The request signal, True when high; each edge that was reported is seen once, in order.

        The value may be some tenths of a second old; `read_signal` asks the controller itself.

        Raises:
            LinkError: The signal cannot be read.
        """
        ...

    def set_ready(self, value: bool) -> None:
        """Write the ready signal; raising it is tried once, so that its caller looks again before the next try.

        Raises:
            LinkError: The signal was not, or perhaps not, written.
        """
        ...

    def read_ready(self) -> bool:
        """The ready signal as the controller has it, never a remembered value.

        Raises:
            LinkError: The signal cannot be read.
        """
        ...

    def read_signal(self, name: str) -> bool:
        """Any signal of `doormill_ros.abb.signals`, as the controller has it.

        Raises:
            LinkError: The signal cannot be read.
        """
        ...

    def read_number(self, name: str) -> int:
        """A group signal's number, as the controller has it.

        Raises:
            UnknownSignalError: The controller has no such signal.
            LinkError: The signal cannot be read.
        """
        ...

    def write_number(self, name: str, value: int) -> None:
        """Write a group signal; a number above 0 is tried once, as raising ready is.

        Raises:
            UnknownSignalError: The controller has no such signal.
            LinkError: The signal was not, or perhaps not, written.
        """
        ...

    def write_file(self, name: str, data: bytes) -> None:
        """Put a file into the controller's HOME folder.

        Raises:
            LinkError: The file was not, or perhaps only in part, written.
        """
        ...

    def read_file(self, name: str) -> bytes:
        """The bytes of a file as the controller would read them.

        Raises:
            FileMissingError: There is no such file.
            LinkError: The file cannot be read.
        """
        ...

    def remove_file(self, name: str) -> None:
        """Remove a file; no error when there is none.

        Raises:
            LinkError: The file is perhaps still there.
        """
        ...

    def wait(self, timeout: float) -> None:
        """Return when a signal may have changed, at the latest after `timeout` [s]. Raises nothing."""
        ...

    def wake(self) -> None:
        """Make a `wait` that is under way, or the next one, return at once; from any thread."""
        ...

    def close(self) -> None:
        """Give back connection, session and locks; calling it again does nothing. Raises nothing."""
        ...


def check_file_name(name: str) -> str:
    """A plain file name that every controller's HOME folder can hold.

    Args:
        name: Candidate, for example "Hei2.txt".

    Returns:
        The same name.

    Raises:
        FileNameError: Folders, hidden files, characters outside letters, digits, "_", "-", "." or more
            than 80 characters (a RAPID string).
    """
    plain = PurePosixPath(name).name == name and not name.startswith(".")
    allowed = all(c.isascii() and (c.isalnum() or c in "_-.") for c in name)
    if not name or not plain or not allowed or len(name) > 80:
        raise FileNameError(
            f"file name on the controller is {name!r}; allowed are up to 80 letters, digits, '_', '-' "
            "and '.', without a folder: choose a plain name such as 'Hei2.txt'",
            name=name,
        )
    return name
