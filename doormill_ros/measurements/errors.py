"""Errors of measured data: tables of trials and poses, tracker and force files, loading tests."""

from __future__ import annotations

from doormill_ros.errors import DataSetError

_row = DataSetError.row

DataFileError = _row("DataFileError", 501, "A file of a set is missing, cannot be opened or is no text.")
SetDescriptionError = _row("SetDescriptionError", 502, "set.yaml lacks a key or holds a value not allowed.")
TrialTableError = _row("TrialTableError", 503, "A table of measured rows has a column or cell of no use.")
SetMixError = _row(
    "SetMixError",
    504,
    "Sets given together describe different robots, models or noise, or have the same name.",
)
PoseTableError = _row("PoseTableError", 510, "poses.csv has a column or cell that cannot be used.")
PosePlacementError = _row(
    "PosePlacementError", 511, "The rows do not tell base-in-tracker and target-in-flange."
)
MotionTableError = _row(
    "MotionTableError", 513, "samples.csv has a column, cell or time that cannot be used."
)
RawFileError = _row("RawFileError", 580, "A laser tracker or force sensor file cannot be read.")
NotSteadyError = _row("NotSteadyError", 581, "A recording holds no steady window that is long enough.")
LoadingTestError = _row("LoadingTestError", 582, "A description of loading tests contradicts its form.")
IdentifiabilityError = _row("IdentifiabilityError", 583, "The loadings tell no joint's stiffness.")
