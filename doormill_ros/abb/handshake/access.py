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
    OtherRunError,
    ReadySignalError,
    RequestWithdrawnError,
    UnknownSignalError,
)
from doormill_ros.abb.transport import Transport, check_file_name

#: What stands before the robot program's own reason, and in its place where it gave none.
FAULT_WHILE_MILLING, NO_REASON = "the robot stopped with a fault while milling: ", "see its pendant"


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
        self._announced = b""

    @property
    def in_doubt(self) -> bool:
        """True while an operation that failed may still take effect on the controller."""
        return self._clock() < self._in_doubt_until

    def expect_latecomers(self) -> None:
        """Treat everything sent before now as in doubt, by a process killed just before as well."""
        self._in_doubt_until = self._clock() + self.transport.in_doubt_time

    def clear(self) -> None:
        """Ready low first, then the files away; what reads back decides, not how the orders were answered.

        The other order would leave ready high without a file, and writing under a high ready would
        let the controller read a half-written one.

        Raises:
            LinkError: The controller is perhaps not cleared.
        """
        self._announced = b""
        refused = self._attempt(lambda: self._write_number(0))
        refused = self._attempt(lambda: self.transport.set_ready(False)) or refused
        try:
            self.require_ready(False)
        except ReadySignalError as error:
            raise refused or error from None
        for name in (self.file_name, signals.ORDER_FILE):
            self._remove(name)

    def _remove(self, name: str) -> None:
        # A removal that arrives late would take away the next file while it is announced.
        refused = self._attempt(lambda: self._doubtful(lambda: self.transport.remove_file(name)))
        try:
            self.transport.read_file(name)
        except FileMissingError:
            return
        raise refused or FileVerificationError(
            f"{name} is still on the controller after it was removed; check its folder's rights", file=name
        )

    def _attempt(self, operation: Callable[[], None]) -> LinkError | None:
        """Give an order and return its refusal; one that may be carried out yet is raised."""
        try:
            operation()
        except LinkError as error:
            if error.in_doubt:
                raise
            return error
        return None

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
        if not self.request_is_high():
            raise RequestWithdrawnError("the request fell while the file was written; request again")
        self._require_mark(request_mark)
        self._announced = request_mark
        number = _number_of(request_mark)
        if number:
            self._doubtful(lambda: self._write_number(number))
        self._doubtful(lambda: self.transport.set_ready(True))
        self.require_announced()

    def require_announced(self) -> None:
        """Ready is high, and for the request for which it was raised; to be asked again and again meanwhile.

        Raises:
            RequestWithdrawnError: The robot program has made another request since.
            ReadySignalError: It does not read high.
            LinkError: It cannot be read.
        """
        self.require_ready(True)
        self._require_mark(self._announced)

    def _require_mark(self, request_mark: bytes) -> None:
        if self.request_mark() != request_mark:
            raise RequestWithdrawnError(
                "the request fell and rose again after the file was made for it; request again"
            )

    def require_ready(self, expected: bool) -> None:
        """Compare the ready signals with what they should be.

        Raises:
            ReadySignalError: One differs.
            LinkError: One cannot be read.
        """
        found = self.transport.read_ready()
        if found is not expected:
            raise ReadySignalError(
                f"{signals.READY} reads {int(found)} where {int(expected)} was written; "
                "check which other program or operator writes it",
                expected=expected,
            )
        if signals.READY_NUMBER in self._absent_signals:
            return
        wanted = _number_of(self._announced)
        try:
            number = self.transport.read_number(signals.READY_NUMBER)
        except UnknownSignalError:
            self._absent_signals.add(signals.READY_NUMBER)
            return
        if number != wanted:
            raise ReadySignalError(
                f"{signals.READY_NUMBER} reads {number} where {wanted} was written; "
                "check which other program or operator writes it",
                expected=wanted,
            )

    def _write_number(self, number: int) -> None:
        """Write the ready number; a controller of the thesis' program has none."""
        if signals.READY_NUMBER in self._absent_signals:
            return
        try:
            self.transport.write_number(signals.READY_NUMBER, number)
        except UnknownSignalError:
            self._absent_signals.add(signals.READY_NUMBER)

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
            OtherRunError: It accepted another run than the one that was announced.
            RequestWithdrawnError: It marks its requests, and neither refused the file nor accepted it.
            LinkError: Its signals or files cannot be read.
        """
        if self.optional_signal(signals.FAULT):
            reason = self.reason_of_fault(request_mark) or "its pendant says why"
            raise FileRefusedError(
                f"the controller refused the file of run {run_id}: {reason}", run_id=run_id
            )
        if not request_mark:
            return
        accepted = self._optional_lines(signals.ACCEPTED_FILE)
        if not accepted:
            raise RequestWithdrawnError(
                "the request fell, but the robot neither refused the file nor accepted it; its program was "
                "probably stopped: start it again"
            )
        if accepted != [run_id, request_mark.decode("ascii", "replace")]:
            raise OtherRunError(
                f"the robot accepted {' for request '.join(accepted)} instead of run {run_id}; stop it and look "
                "at the door",
                run_id=run_id,
                found=accepted[0],
            )

    def reason_of_fault(self, request_mark: bytes) -> str:
        """What the robot program wrote about the fault of this request, empty when it wrote nothing.

        Raises:
            LinkError: Its file cannot be read.
        """
        lines = self._optional_lines(signals.REFUSED_FILE)
        if not request_mark or lines[:1] != [request_mark.decode("ascii", "replace")]:
            return ""
        return " ".join(lines[1:])

    def was_milled(self, run_id: str) -> bool:
        """Whether the robot program notes this run as milled to its end; DONE itself falls with the next request.

        Raises:
            LinkError: Its file cannot be read.
        """
        return self._optional_lines(signals.MILLED_FILE) == [run_id]

    def last_runs(self) -> tuple[str, bytes, str]:
        """What the robot program noted: the run it accepted last, its request's mark, and the run it milled last.

        Raises:
            LinkError: Its files cannot be read.
        """
        accepted = [*self._optional_lines(signals.ACCEPTED_FILE), "", ""]
        milled = [*self._optional_lines(signals.MILLED_FILE), ""]
        return accepted[0], accepted[1].encode("ascii", "replace"), milled[0]

    def name_door(self, door_id: str) -> None:
        """Tell the robot program which door is being loaded.

        Raises:
            LinkError: The file is perhaps not there.
        """
        content = f"{door_id}\n{signals.EXPECTED_END}\n".encode("ascii")
        self.transport.write_file(signals.EXPECTED_FILE, content)

    def _optional_lines(self, name: str) -> list[str]:
        try:
            return self.transport.read_file(name).decode("ascii", "replace").splitlines()
        except FileMissingError:
            return []

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


def _number_of(request_mark: bytes) -> int:
    """The number that ready carries for a request; 0 for a program that does not number its requests."""
    number = int(request_mark) if request_mark.isdigit() else 0
    return number if number <= signals.LARGEST_NUMBER else 0
