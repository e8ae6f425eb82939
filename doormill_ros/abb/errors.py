"""Errors of the ABB side. Codes 400..449: files and RAPID; 450..499: link and handshake.

AbbError 400
|-- TargetValueError 401         a target or name cannot be written into a target file
|-- TargetProgramError 402       targets and motions do not fit together
|-- TargetLineError 403          a line of a target file is not what it should be
|-- TargetFileCutShortError 404  a target file ends too early
|-- TargetFileChecksumError 405  a target file was changed after it was written
|-- WrongDoorError 406           a target file belongs to another door
|-- StaleRunError 407            a target file was milled before
|-- TargetFileWriteError 408      a file could not be written, or reads back differently
|-- RapidSyntaxError 410         a RAPID module does not parse
|-- RapidUnsupportedError 411    valid RAPID outside the executed subset
|-- RapidProgramError 412        a RAPID module that a controller would refuse to load
|-- RapidRuntimeError 413        an error that no error handler of the RAPID program took
|-- RapidMotionError 414         the motion supervision stopped the robot
|-- RapidStoppedError 415        the program was stopped from outside or ran too long
`-- SignalError 416              a signal that does not exist or cannot hold the value
"""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class AbbError(DoormillError):
    """Anything that goes wrong between the path and the robot controller."""

    code = 400


class TargetValueError(AbbError):
    """A value that a target file cannot hold."""

    code = 401


class TargetProgramError(AbbError):
    """A milling program whose targets and motions do not fit together."""

    code = 402


class TargetLineError(AbbError):
    """A line of a target file that is not what it should be."""

    code = 403


class TargetFileCutShortError(AbbError):
    """A target file that ends before its checksum line."""

    code = 404


class TargetFileChecksumError(AbbError):
    """A target file that was changed after it was written."""

    code = 405


class WrongDoorError(AbbError):
    """A target file that was made for another door."""

    code = 406


class StaleRunError(AbbError):
    """A target file whose run was executed before."""

    code = 407


class TargetFileWriteError(AbbError):
    """A file that could not be written, or that reads back differently."""

    code = 408


class RapidSyntaxError(AbbError):
    """A RAPID module that does not parse."""

    code = 410


class RapidUnsupportedError(AbbError):
    """Valid RAPID that the virtual controller does not execute."""

    code = 411


class RapidProgramError(AbbError):
    """A RAPID module that parses, yet that a controller would refuse to load."""

    code = 412


class RapidRuntimeError(AbbError):
    """An error during execution that no error handler of the program took."""

    code = 413


class RapidMotionError(AbbError):
    """A motion that the supervision of the robot stopped."""

    code = 414


class RapidStoppedError(AbbError):
    """A program that was stopped from outside, or that ran longer than allowed."""

    code = 415


class SignalError(AbbError):
    """A signal that does not exist, or that cannot hold the value."""

    code = 416
