"""What can go wrong between the PC and the controller, by phase; codes 450..499.

AbbError
`-- LinkError
    |-- connecting   ConnectError 450, ConnectTimeoutError 451, LoginError 452, CertificateError 453,
    |                ControllerBusyError 454, FolderMissingError 455, FolderInUseError 456,
    |                UnknownTransportError 476
    |-- signals      SignalReadError 457, SignalWriteError 458, SignalAccessError 459,
    |                UnknownSignalError 460, ReadySignalError 461
    |-- files        DownloadError 462, UploadError 463, FileMissingError 464, FileNameError 465,
    |                FileVerificationError 466, RemoveError 467
    |-- wire         ReadTimeoutError 468, WriteTimeoutError 469, ConnectionLostError 470,
    |                ControllerReplyError 471, SubscriptionError 472
    |-- credentials  CredentialsMissingError 473, CredentialsPermissionError 474, CredentialsFormatError 475
    `-- handshake    NoRequestError 480, HandshakeBusyError 481, StaleSubmissionError 482,
                     RepeatedRunError 483, EmptyTargetFileError 484, SubmissionTimeoutError 485,
                     AcknowledgeTimeoutError 486, RequestWithdrawnError 487, FileRefusedError 488,
                     RunAbortedError 489, MillingTimeoutError 490,
                     MillingFaultError 491
"""

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


class ConnectTimeoutError(LinkError):
    """The controller did not accept the connection in time."""

    code = 451
    connection = True


class LoginError(LinkError):
    """The controller refuses user or password."""

    code = 452
    connection = True


class CertificateError(LinkError):
    """The controller's certificate is not the pinned one."""

    code = 453
    connection = True


class ControllerBusyError(LinkError):
    """The controller has no free session or asks to slow down (503)."""

    code = 454
    connection = True


class FolderMissingError(LinkError):
    """The shared folder is not there."""

    code = 455
    connection = True


class FolderInUseError(LinkError):
    """Another process holds the shared folder."""

    code = 456


class SignalReadError(LinkError):
    """A signal's value cannot be read or is neither 0 nor 1."""

    code = 457
    connection = True


class SignalWriteError(LinkError):
    """A signal's value cannot be written."""

    code = 458


class SignalAccessError(LinkError):
    """The controller rejects the write: the signal's access level does not allow it."""

    code = 459


class UnknownSignalError(LinkError):
    """The controller has no signal of that name."""

    code = 460


class ReadySignalError(LinkError):
    """The ready signal does not have the value that was written."""

    code = 461


class DownloadError(LinkError):
    """A file on the controller cannot be read."""

    code = 462


class UploadError(LinkError):
    """A file on the controller cannot be written."""

    code = 463


class FileMissingError(LinkError):
    """A file is not on the controller."""

    code = 464


class FileNameError(LinkError):
    """A file name that could leave the folder or that the controller cannot hold."""

    code = 465


class FileVerificationError(LinkError):
    """The file read back is not the file that was written."""

    code = 466


class RemoveError(LinkError):
    """A file on the controller cannot be removed."""

    code = 467


class ReadTimeoutError(LinkError):
    """The controller did not answer in time."""

    code = 468
    connection = True
    in_doubt = True


class WriteTimeoutError(LinkError):
    """The controller did not take the data in time."""

    code = 469
    connection = True
    in_doubt = True


class ConnectionLostError(LinkError):
    """The connection broke during an operation; whether it was done is not known."""

    code = 470
    connection = True
    in_doubt = True


class ControllerReplyError(LinkError):
    """An answer of the controller that the protocol does not foresee."""

    code = 471
    connection = True


class SubscriptionError(LinkError):
    """Events cannot be subscribed to; signals are polled instead."""

    code = 472


class CredentialsMissingError(LinkError):
    """No user and password were given."""

    code = 473


class CredentialsPermissionError(LinkError):
    """Others may read the file with the password."""

    code = 474


class CredentialsFormatError(LinkError):
    """The file with the password cannot be understood."""

    code = 475


class UnknownTransportError(LinkError):
    """There is no transport of that name."""

    code = 476


class NoRequestError(LinkError):
    """A file was submitted although the controller asks for none."""

    code = 480


class HandshakeBusyError(LinkError):
    """A file was submitted while another one is being handed over."""

    code = 481


class StaleSubmissionError(LinkError):
    """A file was submitted for an earlier request than the present one."""

    code = 482


class RepeatedRunError(LinkError):
    """The run id was used before."""

    code = 483


class EmptyTargetFileError(LinkError):
    """The submitted file has no content or no name of run or door."""

    code = 484


class SubmissionTimeoutError(LinkError):
    """Nobody submitted a file for the request in time."""

    code = 485


class AcknowledgeTimeoutError(LinkError):
    """The controller did not acknowledge the file in time."""

    code = 486


class RequestWithdrawnError(LinkError):
    """The request fell before the file was ready."""

    code = 487


class FileRefusedError(LinkError):
    """The controller read the file and refused it."""

    code = 488


class RunAbortedError(LinkError):
    """The run was given up by its owner."""

    code = 489


class MillingTimeoutError(LinkError):
    """The controller did not report the end of milling in time."""

    code = 490


class MillingFaultError(LinkError):
    """The controller stopped with a fault while it milled."""

    code = 491
