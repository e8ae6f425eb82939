"""Errors of robot models that were written to a file."""

from __future__ import annotations

from doormill_ros.errors import DataSetError

ExtendedModelError = DataSetError.row(
    "ExtendedModelError", 505, "An extended model's file cannot be read or used."
)
PoseModelError = DataSetError.row(
    "PoseModelError", 512, "A pose diagnosis' model.yaml cannot be read or used."
)
