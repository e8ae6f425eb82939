"""Errors of the simulated controller: a RAPID program that it refuses or stops; codes 410..419."""

from __future__ import annotations

from doormill_ros.abb.errors import AbbError


class RapidProgramError(AbbError):
    """A RAPID module that parses, yet that a controller would refuse to load."""

    code = 412


class RapidRuntimeError(AbbError):
    """An error during execution that no error handler of the program took."""

    code = 413


class RapidStoppedError(AbbError):
    """A program that was stopped from outside, or that ran longer than allowed."""

    code = 415


RapidSyntaxError = AbbError.row("RapidSyntaxError", 410, "A RAPID module that does not parse.")
RapidUnsupportedError = AbbError.row("RapidUnsupportedError", 411, "Valid RAPID that is not executed here.")
RapidMotionError = AbbError.row("RapidMotionError", 414, "A motion that the supervision stopped.")
SignalError = AbbError.row("SignalError", 416, "A signal that does not exist, or that cannot hold the value.")
EventRoutinesError = AbbError.row(
    "EventRoutinesError", 419, "System parameters that name event routines which cannot be."
)
OrderRefusedError = AbbError.row(
    "OrderRefusedError", 418, "An order that the simulated controller refuses in its present state."
)
