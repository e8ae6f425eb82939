"""A folder that stands for a controller in simulation: its HOME, with the signals as files beside it.

No controller shows its signals as files; a real one is reached by Robot Web Services.

<folder>/Hei2.txt             the target file
<folder>/io/doPathRequest     "0" or "1", see doormill_ros.abb.signals
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from doormill_ros.abb import signals
from doormill_ros.abb.analog_inputs import decimal
from doormill_ros.abb.link_errors import (
    DownloadError,
    FileMissingError,
    FolderInUseError,
    FolderMissingError,
    LinkError,
    ReadTimeoutError,
    RemoveError,
    SignalReadError,
    SignalWriteError,
    UnknownSignalError,
    UploadError,
    WriteTimeoutError,
)
from doormill_ros.abb.transport import check_file_name
from doormill_ros.abb.transport_kind import TransportKind
from doormill_ros.abb.transports.bounded import BoundedCaller, CallTimeout
from doormill_ros.files import write_atomically

T = TypeVar("T")

LOCK_FILE = ".doormill_ros.lock"
LEFT_OVER = ".doormill-tmp"  # ends the name of a file that a killed bridge was writing
_LOOK = "see that this user may read and write the simulated cell's folder"
# A reader can meet the instant between truncation and content when the other side does not replace its
# signal file; that passes within a few milliseconds.
_TORN_READS = 5
_TORN_PAUSE = 0.002


class SimulatedFolderTransport:
    """Signals and target files in one folder; see `Transport` for the operations.

    Calls run on one worker thread in order, because a disk that hangs blocks in the kernel where no
    timeout reaches. As they cannot overtake each other nothing stays in doubt once a later one
    succeeds, hence `in_doubt_time` is 0.
    """

    in_doubt_time = 0.0

    def __init__(self, folder: str | Path, timeout: float = 2.0, poll_interval: float = 0.005) -> None:
        """Take the folder for this process alone and remove what a killed writer left half done.

        Args:
            folder: The simulated controller's HOME; must exist.
            timeout: Limit of one operation [s].
            poll_interval: Longest sleep of `wait` [s].

        Raises:
            FolderMissingError: The folder is not there or cannot be used.
            FolderInUseError: Another process holds it.
            ReadTimeoutError: The folder does not answer.
        """
        self._folder = Path(folder)
        self._io = self._folder / signals.IO_FOLDER
        self._timeout = timeout
        self._poll_interval = poll_interval
        self._lock: int | None = None
        self._woken = threading.Event()
        self._worker = BoundedCaller("simulated-folder")
        try:
            self._bounded(self._open, ReadTimeoutError, "opening")
        except Exception:
            self.close()
            raise

    def __repr__(self) -> str:
        return f"SimulatedFolderTransport({str(self._folder)!r})"

    def read_request(self) -> bool:
        """The request signal, True when high."""
        return self.read_signal(signals.REQUEST)

    def read_ready(self) -> bool:
        """The ready signal as it is in the folder."""
        return self.read_signal(signals.READY)

    def read_signal(self, name: str) -> bool:
        """Any signal; a missing file is low."""
        return self._bounded(lambda: self._read_signal(name), ReadTimeoutError, f"reading signal {name}")

    def set_ready(self, value: bool) -> None:
        """Replace the ready signal's file."""
        self._bounded(
            lambda: self._write_signal(signals.READY, int(value)),
            WriteTimeoutError,
            f"writing {signals.READY}",
        )

    def read_number(self, name: str) -> int:
        """A group signal's number; a missing file is 0."""
        return self._bounded(lambda: self._read_number(name), ReadTimeoutError, f"reading signal {name}")

    def read_analog(self, name: str) -> float:
        """An analog signal; a missing file is no such signal."""
        return self._bounded(lambda: self._read_analog(name), ReadTimeoutError, f"reading signal {name}")

    def write_number(self, name: str, value: int) -> None:
        """Replace the group signal's file."""
        self._bounded(lambda: self._write_signal(name, value), WriteTimeoutError, f"writing {name}")

    def write_file(self, name: str, data: bytes) -> None:
        """Write beside the target, then replace in one step."""
        path = self._folder / check_file_name(name)
        self._bounded(lambda: self._replace(path, data), WriteTimeoutError, f"writing {name}")

    def read_file(self, name: str) -> bytes:
        """The file's bytes."""
        path = self._folder / check_file_name(name)
        return self._bounded(lambda: _read(path), ReadTimeoutError, f"reading {name}")

    def remove_file(self, name: str) -> None:
        """Remove the file if it is there."""
        path = self._folder / check_file_name(name)
        self._bounded(lambda: _remove(path), WriteTimeoutError, f"removing {name}")

    def wait(self, timeout: float) -> None:
        """Sleep for one polling interval: the simulated controller tells nobody about changes."""
        self._woken.wait(max(0.0, min(timeout, self._poll_interval)))
        self._woken.clear()

    def wake(self) -> None:
        """End a `wait`."""
        self._woken.set()

    def close(self) -> None:
        """Give the folder back."""
        if self._lock is not None:
            with contextlib.suppress(OSError):
                os.close(self._lock)
            self._lock = None
        self._worker.close()

    def _bounded(self, function: Callable[[], T], timeout_error: type[LinkError], doing: str) -> T:
        try:
            return self._worker.call(function, self._timeout)
        except CallTimeout:
            raise timeout_error(
                f"{doing} in simulated folder {self._folder} took longer than {self._timeout:g} s; "
                "see what keeps the disk busy, or give the simulated cell a folder on a local one",
                folder=str(self._folder),
                timeout=self._timeout,
            ) from None

    def _open(self) -> None:
        if not self._folder.is_dir():
            raise FolderMissingError(
                f"simulated folder {self._folder} does not exist; start the simulated controller first, which makes "
                "it (home of /controller_simulator), correct the path, or name the transport of a real controller",
                folder=str(self._folder),
            )
        try:
            self._io.mkdir(exist_ok=True)
            self._lock = os.open(self._folder / LOCK_FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
            _lock(self._lock, self._folder)
            for left_over in (*self._folder.glob(f".*{LEFT_OVER}"), *self._io.glob(f".*{LEFT_OVER}")):
                left_over.unlink(missing_ok=True)
        except OSError as error:
            raise FolderMissingError(
                f"simulated folder {self._folder} cannot be used: {error.strerror}; give this user write access",
                folder=str(self._folder),
            ) from error

    def _read_signal(self, name: str) -> bool:
        value = self._read_number(name)
        if value > 1:
            raise SignalReadError(
                f"signal {name} is {value} in {self._io}; allowed are '0' and '1': check who else writes it",
                signal=name,
            )
        return value == 1

    def _read_number(self, name: str) -> int:
        content = self._read_content(name, bytes.isdigit)
        if content is None:
            return 0
        if not content.isdigit():
            raise SignalReadError(
                f"signal {name} is {content[:20]!r} in {self._io / name}; allowed are '0' and '1', for a group a "
                "decimal number: check who else writes it",
                signal=name,
            )
        return int(content)

    def _read_analog(self, name: str) -> float:
        content = self._read_content(name, lambda text: decimal(text.decode("latin-1")) is not None)
        if content is None:
            raise UnknownSignalError(
                f"the controller has no signal {name}: there is no file {self._io / name}", signal=name
            )
        value = decimal(content.decode("latin-1"))
        if value is None:
            raise SignalReadError(
                f"signal {name} is {content[:20]!r} in {self._io / name}; allowed is a decimal number: check who else "
                "writes it",
                signal=name,
            )
        return value

    def _read_content(self, name: str, whole: Callable[[bytes], bool]) -> bytes | None:
        """What a signal's file holds, read again where that is not whole; None without a file."""
        path = self._io / check_file_name(name)
        content = b""
        for attempt in range(_TORN_READS):
            if attempt:
                time.sleep(_TORN_PAUSE)
            try:
                content = path.read_bytes().strip()
            except FileNotFoundError:
                if self._io.is_dir():
                    return None
                raise SignalReadError(
                    f"signal {name} cannot be read: {self._io} is gone; start the simulated cell again",
                    signal=name,
                ) from None
            except OSError as error:
                raise SignalReadError(
                    f"signal {name} cannot be read: {error.strerror} ({path}); {_LOOK}",
                    signal=name,
                ) from error
            if whole(content):
                break
        return content

    def _write_signal(self, name: str, value: int) -> None:
        path = self._io / check_file_name(name)
        try:
            self._replace(path, b"%d" % value)
        except UploadError as error:
            # Lowering must work on a full disk too, and a missing file reads as low.
            if not value:
                with contextlib.suppress(OSError):
                    path.unlink(missing_ok=True)
                    return
            raise SignalWriteError(
                f"signal {name} cannot be written: {error.message}", signal=name
            ) from error

    def _replace(self, path: Path, data: bytes) -> None:
        try:
            # Not flushed to the medium: after a power cut nobody reads a stale file, because a start clears.
            write_atomically(path, data, suffix=LEFT_OVER)
        except OSError as error:
            cause = "the disk is full" if error.errno in (errno.ENOSPC, errno.EDQUOT) else error.strerror
            raise UploadError(
                f"{path} cannot be written ({len(data)} bytes): {cause}; free space, or {_LOOK}",
                path=str(path),
                errno=error.errno,
            ) from error


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise FolderInUseError(
            f"simulated folder {folder} is held by another process; two writers could mix their files: "
            "stop the other abb_bridge first",
            folder=str(folder),
        ) from None
    except OSError as error:
        # Some file systems know no locks; the handshake's own checks still hold there.
        if error.errno not in (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL):
            raise


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise FileMissingError(f"{path} does not exist; write it first", path=str(path)) from None
    except OSError as error:
        raise DownloadError(f"{path} cannot be read: {error.strerror}; {_LOOK}", path=str(path)) from error


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise RemoveError(
            f"{path} cannot be removed: {error.strerror}; close the program that holds it", path=str(path)
        ) from error


KIND = TransportKind(
    lambda options: SimulatedFolderTransport(options.address, options.answer),
    address="HOME",
    moves_robot=False,
)
