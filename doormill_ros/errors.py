"""Base of every error that bad input can cause, and the number ranges of the codes.

    DoormillError
    |-- 100..199  RecipeError         doormill_ros.recipes.errors
    |-- 200..299  LocalizationError   doormill_ros.localization.errors
    |-- 300..399  PathError           doormill_ros.toolpath.errors (reach, limits, correction)
    |-- 400..499  AbbError            doormill_ros.abb.errors (target file, handshake, transport, RAPID)
    |-- 500..599  DataSetError        doormill_ros.measurements.errors (measurement and pose sets)
    |-- 600..699  BagError            doormill_ros.recording.errors
    |-- 700..799  RobotError          doormill_ros.robot.errors (description, kinematics)
    `-- 800..899  CellError           doormill_ros.cell.errors (the run as a whole)

Each leaf class has one code of its own; messages and action results carry it as `error_code`.
"""

from __future__ import annotations

from typing import Any, ClassVar


class DoormillError(Exception):
    """One clear sentence about bad input: what, found, allowed, what to do.

    Attributes:
        code: Stable number of the error class; 0 is reserved for success.
        data: The offending values by name, for logs and messages.
    """

    code: ClassVar[int] = 1

    def __init__(self, message: str, **data: Any) -> None:
        """Keep the sentence and the offending values."""
        super().__init__(message)
        self.message = message
        self.data = data


class DataSetError(DoormillError):
    """Measured data, or a model made from it, that cannot be used."""

    code = 500
