"""Errors of robot models that stand in a file."""

from __future__ import annotations

from doormill_ros.errors import DataSetError

ExtendedModelError = DataSetError.row(
    "ExtendedModelError", 505, "An extended model's file cannot be read or used."
)
LinkMassError = DataSetError.row(
    "LinkMassError", 506, "A file of published link masses cannot be read or used."
)
PoseModelError = DataSetError.row(
    "PoseModelError", 512, "A pose diagnosis' model.yaml cannot be read or used."
)
MotionModelError = DataSetError.row(
    "MotionModelError", 514, "A model.yaml of moving joints cannot be read or used."
)
