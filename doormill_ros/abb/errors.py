"""Errors of the target file; codes 400..409. Those of the link to the controller stand in `link_errors`."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class AbbError(DoormillError):
    """Anything that goes wrong between the path and the robot controller."""

    code = 400


TargetValueError = AbbError.row("TargetValueError", 401, "A value that a target file cannot hold.")
TargetProgramError = AbbError.row("TargetProgramError", 402, "Targets and motions do not fit together.")
TargetLineError = AbbError.row("TargetLineError", 403, "A line is not what it should be.")
TargetFileCutShortError = AbbError.row(
    "TargetFileCutShortError", 404, "The file ends before its checksum line."
)
TargetFileChecksumError = AbbError.row(
    "TargetFileChecksumError", 405, "The file was changed after it was written."
)
WrongDoorError = AbbError.row("WrongDoorError", 406, "A target file that was made for another door.")
StaleRunError = AbbError.row("StaleRunError", 407, "A target file whose run was executed before.")
TargetFileWriteError = AbbError.row(
    "TargetFileWriteError", 408, "A file is not written, or reads back differently."
)
