"""What can go wrong between the PC and the controller, by phase; codes 450..499."""

from __future__ import annotations

from typing import ClassVar

from doormill_ros.abb.errors import AbbError


class LinkError(AbbError):
    """Base of the errors of transports, credentials and handshake.

    Attributes:
        connection: True when signals may have changed unseen because the controller was out of reach.
        in_doubt: True when the operation may have been carried out, or may be later.
    """

    code = 499
    connection: ClassVar[bool] = False
    in_doubt: ClassVar[bool] = False


class ConnectError(LinkError):
    """The controller cannot be reached."""

    code = 450
    connection = True


class UnknownSignalError(LinkError):
    """The controller has no signal of that name."""

    code = 460


class UploadError(LinkError):
    """A file on the controller cannot be written."""

    code = 463


class FileMissingError(LinkError):
    """A file is not on the controller."""

    code = 464


class ConnectionLostError(LinkError):
    """The connection broke during an operation; whether it was done is not known."""

    code = 470
    connection = True
    in_doubt = True


class RequestWithdrawnError(LinkError):
    """The request fell before the file was ready."""

    code = 487


class MillingTimeoutError(LinkError):
    """The controller did not report the end of milling in time."""

    code = 490


class MillingFaultError(LinkError):
    """The controller stopped with a fault while it milled."""

    code = 491


_row = LinkError.row

# Connecting.
ConnectTimeoutError = _row(
    "ConnectTimeoutError", 451, "No connection to the controller in time.", connection=True
)
LoginError = _row("LoginError", 452, "The controller refuses user or password.", connection=True)
CertificateError = _row("CertificateError", 453, "The certificate is not the pinned one.", connection=True)
ControllerBusyError = _row(
    "ControllerBusyError", 454, "No free session, or slow down (503).", connection=True
)
FolderMissingError = _row(
    "FolderMissingError", 455, "The simulated controller's folder is not there.", connection=True
)
FolderInUseError = _row("FolderInUseError", 456, "Another process holds the simulated controller's folder.")
SessionExpiredError = _row(
    "SessionExpiredError", 477, "The web session had ended; what was asked for was not done.", connection=True
)
UnknownTransportError = _row("UnknownTransportError", 476, "There is no transport of that name.")

ControllerStateError = _row(
    "ControllerStateError", 478, "The controller's state does not let the robot take a file."
)

# Signals.
SignalReadError = _row(
    "SignalReadError", 457, "A signal cannot be read or is neither 0 nor 1.", connection=True
)
SignalWriteError = _row("SignalWriteError", 458, "A signal's value cannot be written.")
SignalAccessError = _row("SignalAccessError", 459, "The signal's access level does not allow the write.")
WriteAccessError = _row("WriteAccessError", 479, "RobotWare 8 does not let this PC write.")
ReadySignalError = _row("ReadySignalError", 461, "The ready signal does not have the value that was written.")

# Files.
DownloadError = _row("DownloadError", 462, "A file on the controller cannot be read.")
FileNameError = _row(
    "FileNameError", 465, "A file name leaves the folder or is none the controller can hold."
)
FileVerificationError = _row("FileVerificationError", 466, "The file read back is not the file written.")
RemoveError = _row("RemoveError", 467, "A file on the controller cannot be removed.")

# The wire.
ReadTimeoutError = _row("ReadTimeoutError", 468, "No answer in time.", connection=True, in_doubt=True)
WriteTimeoutError = _row("WriteTimeoutError", 469, "Data not taken in time.", connection=True, in_doubt=True)
ControllerReplyError = _row("ControllerReplyError", 471, "A reply outside the protocol.", connection=True)
SubscriptionError = _row(
    "SubscriptionError", 472, "No events can be subscribed to; signals are polled instead."
)

# Credentials.
CredentialsMissingError = _row("CredentialsMissingError", 473, "No user and password were given.")
CredentialsPermissionError = _row(
    "CredentialsPermissionError", 474, "Others may read the file with the password."
)
CredentialsFormatError = _row("CredentialsFormatError", 475, "The file with the password is not understood.")

# The handshake.
NoRequestError = _row("NoRequestError", 480, "A file was submitted although the controller asks for none.")
HandshakeBusyError = _row("HandshakeBusyError", 481, "A file was submitted while another is handed over.")
StaleSubmissionError = _row("StaleSubmissionError", 482, "A file was submitted for an earlier request.")
RepeatedRunError = _row("RepeatedRunError", 483, "The run id was used before.")
EmptyTargetFileError = _row("EmptyTargetFileError", 484, "The file has no content or no name of run or door.")
SubmissionTimeoutError = _row(
    "SubmissionTimeoutError", 485, "Nobody submitted a file for the request in time."
)
AcknowledgeTimeoutError = _row("AcknowledgeTimeoutError", 486, "The file was not acknowledged in time.")
FileRefusedError = _row("FileRefusedError", 488, "The controller read the file and refused it.")
DoorNameError = _row("DoorNameError", 493, "The name of a door is none that the controller can hold.")
OtherRunError = _row("OtherRunError", 492, "The controller accepted another run than was announced.")
RunAbortedError = _row("RunAbortedError", 489, "The run was given up by its owner.")
