"""The handshake's operations on the controller, each read back before it counts as done."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.abb import signals
from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.handshake.inbox import Submission
from doormill_ros.abb.link_errors import (
    FileMissingError,
    FileRefusedError,
    FileVerificationError,
    LinkError,
    ReadySignalError,
    RequestWithdrawnError,
    UnknownSignalError,
)
from doormill_ros.abb.transport import Transport, check_file_name


class ControllerAccess:
    """Clear, write, verify and announce one target file through a transport."""

    def __init__(
        self,
        transport: Transport,
        clock: Callable[[], float],
        file_name: str,
        check: Callable[[bytes, str, str], object] | None,
    ) -> None:
        """Keep the parts; nothing is sent.

        Raises:
            FileNameError: `file_name` is not a plain file name.
        """
        self.transport = transport
        self.file_name = check_file_name(file_name)
        self._clock = clock
        self._check = check
        self._in_doubt_until = float("-inf")
        self._absent_signals: set[str] = set()

    @property
    def in_doubt(self) -> bool:
        """True while an operation that failed may still take effect on the controller."""
        return self._clock() < self._in_doubt_until

    def expect_latecomers(self) -> None:
        """Treat everything sent before now as in doubt, by a process killed just before as well."""
        self._in_doubt_until = self._clock() + self.transport.in_doubt_time

    def clear(self) -> None:
        """Ready low first, then the file away, both read back.

        The other order would leave ready high without a file, and writing under a high ready would
        let the controller read a half-written one.

        Raises:
            LinkError: The controller is perhaps not cleared.
        """
        self.transport.set_ready(False)
        self.require_ready(False)
        # A removal that arrives late would take away the next file while it is announced.
        self._doubtful(lambda: self.transport.remove_file(self.file_name))
        self._doubtful(lambda: self.transport.remove_file(signals.ORDER_FILE))
        try:
            self.transport.read_file(self.file_name)
        except FileMissingError:
            return
        raise FileVerificationError(
            f"{self.file_name} is still on the controller after it was removed; check its folder's rights",
            file=self.file_name,
        )

    def write(self, submission: Submission) -> None:
        """Put the file into place; what is there afterwards must be verified.

        Raises:
            LinkError: The file is perhaps not, or only in part, there.
        """
        self.require_ready(False)
        self._doubtful(lambda: self.transport.write_file(self.file_name, submission.data))

    def verify(self, submission: Submission) -> None:
        """Read the file back, compare every byte and check its content.

        Raises:
            FileVerificationError: It is not the submitted file, or not one of its run and door.
            LinkError: It cannot be read.
        """
        found = self._compare(self.file_name, submission.data)
        if self._check is None:
            return
        try:
            self._check(found, submission.run_id, submission.door_id)
        except AbbError as error:
            raise FileVerificationError(
                f"{self.file_name} is not the target file of run {submission.run_id} for door "
                f"{submission.door_id}: {error.message}",
                file=self.file_name,
            ) from error

    def request_mark(self) -> bytes:
        """What the robot program wrote about its present request; empty from a program that writes nothing.

        Raises:
            LinkError: It cannot be read.
        """
        try:
            return self.transport.read_file(signals.REQUEST_FILE).strip()[:80]
        except FileMissingError:
            return b""

    def announce(self, submission: Submission, request_mark: bytes) -> None:
        """Name run and request in the order file, then set ready and read it back.

        Operations go out one at a time, so of an earlier attempt either the target file or the order
        file can arrive late, not both: the robot program sees that they do not agree.

        Raises:
            RequestWithdrawnError: It is not the request any more that the file was made for.
            ReadySignalError: It does not read high.
            LinkError: It is perhaps not high, or will be later.
        """
        order = submission.run_id.encode("ascii", "backslashreplace") + b"\n"
        order += request_mark + b"\n" if request_mark else b""
        self._doubtful(lambda: self.transport.write_file(signals.ORDER_FILE, order))
        self._compare(signals.ORDER_FILE, order)
        if not self.request_is_high() or self.request_mark() != request_mark:
            raise RequestWithdrawnError(
                "the request fell, or fell and rose again, while the file was written; request again"
            )
        self._doubtful(lambda: self.transport.set_ready(True))
        self.require_ready(True)

    def require_ready(self, expected: bool) -> None:
        """Compare the ready signal with what it should be.

        Raises:
            ReadySignalError: It differs.
            LinkError: It cannot be read.
        """
        if self.transport.read_ready() is not expected:
            raise ReadySignalError(
                f"{signals.READY} reads {int(not expected)} where {int(expected)} was written; "
                "check which other program or operator writes it",
                expected=expected,
            )

    def request_is_high(self) -> bool:
        """The request asked of the controller itself: an event may be late or lost.

        Raises:
            LinkError: It cannot be read.
        """
        return self.transport.read_signal(signals.REQUEST)

    def optional_signal(self, name: str) -> bool:
        """A signal that an older robot program may lack; absent is low.

        Raises:
            LinkError: It cannot be read.
        """
        if name in self._absent_signals:
            return False
        try:
            return self.transport.read_signal(name)
        except UnknownSignalError:
            self._absent_signals.add(name)
            return False

    def require_taken(self, run_id: str, request_mark: bytes) -> None:
        """What the robot program made of the file, to be asked while ready is still high.

        Once ready is low the program may clear FAULT and request again.

        Raises:
            FileRefusedError: It refused the file.
            RequestWithdrawnError: It marks its requests, and neither refused the file nor began to mill.
            LinkError: Its signals cannot be read.
        """
        if self.optional_signal(signals.FAULT):
            raise FileRefusedError(
                f"the controller refused the file of run {run_id}; its pendant says why", run_id=run_id
            )
        # Twice: between the end of BUSY and the start of DONE both are low for an instant.
        began = any(self.optional_signal(name) for name in 2 * (signals.BUSY, signals.DONE))
        if request_mark and not began:
            raise RequestWithdrawnError(
                "the request fell, but the robot neither refused the file nor began to mill; its program was "
                "probably stopped: start it again"
            )

    def _compare(self, name: str, expected: bytes) -> bytes:
        found = self.transport.read_file(name)
        if found != expected:
            shorter = min(len(found), len(expected))
            first = next((i for i in range(shorter) if found[i] != expected[i]), shorter)
            raise FileVerificationError(
                f"{name} reads back with {len(found)} bytes instead of {len(expected)}, first "
                f"difference at byte {first}; check disk space and connection of the controller",
                file=name,
                first_difference=first,
            )
        return found

    def _doubtful(self, operation: Callable[[], None]) -> None:
        try:
            operation()
        except LinkError as error:
            if error.in_doubt:
                self.expect_latecomers()
            raise
