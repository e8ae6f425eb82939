"""What can end a run that is nobody's fault in particular; codes 800..899."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class CellError(DoormillError):
    """Base of the errors of a run as a whole."""


class StageTimeoutError(CellError):
    """A stage gave no answer in time."""

    code = 801


class StageRefusedError(CellError):
    """Another node refused the run; `stage_code` is the code it gave."""

    code = 805

    def __init__(self, message: str, stage_code: int) -> None:
        """Keep the node's sentence and code; whoever answers with the error's code tells the node's."""
        super().__init__(message, stage_code=stage_code)
        self.code = self.stage_code = stage_code


CellBusyError = CellError.row("CellBusyError", 802, "Another door is being milled.")
RunCanceledError = CellError.row("RunCanceledError", 803, "The run was canceled by whoever started it.")
NodeInactiveError = CellError.row("NodeInactiveError", 804, "A node that the run needs is not active.")
OutOfToleranceError = CellError.row(
    "OutOfToleranceError", 807, "The door was milled, but a feature is beyond its tolerance."
)
NodeDeadError = CellError.row("NodeDeadError", 808, "A node that the run needs has died.")
NodeDoubledError = CellError.row(
    "NodeDoubledError",
    809,
    "Two nodes of one name are in one network and namespace, or two bridges on one controller.",
)
RunCutOffError = CellError.row(
    "RunCutOffError", 810, "The bridge died or was ended in the middle of the run."
)
BadParameterError = CellError.row(
    "BadParameterError", 811, "A node was started with a value that a parameter cannot have."
)
WrongGoalError = CellError.row(
    "WrongGoalError",
    812,
    "A goal for a whole door came to a robot that mills shares, or the other way round.",
)
RosArgumentsError = CellError.row(
    "RosArgumentsError", 813, "ROS 2 does not start: its arguments or a parameter file cannot be read."
)
RunNoteError = CellError.row(
    "RunNoteError", 883, "It cannot be written down which run is in hand, so none is begun."
)
BadCellFile = CellError.row("BadCellFile", 806, "The cell's file lacks a key or is out of bounds.")
