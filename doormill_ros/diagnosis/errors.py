"""Errors of measured data and of what is made from them.

DataSetError 500
|-- DataFileError 501        a file of the set is missing or is no text
|-- SetDescriptionError 502  set.yaml lacks something or holds an impossible value
|-- TrialTableError 503      trials.csv has a cell or column that cannot be used
|-- SetMixError 504          sets given together do not belong together
|-- ExtendedModelError 505   a model.yaml cannot be used
`-- PoseTableError 510..519  pose sets, doormill_ros.diagnosis.pose
"""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class DataSetError(DoormillError):
    """Measured data that cannot be used."""

    code = 500


class DataFileError(DataSetError):
    """A file of a set is missing, cannot be opened or is no text."""

    code = 501


class SetDescriptionError(DataSetError):
    """set.yaml lacks a key or holds a value that is not allowed."""

    code = 502


class TrialTableError(DataSetError):
    """A table of measured rows has a column or cell that cannot be used."""

    code = 503


class SetMixError(DataSetError):
    """Sets that were given together describe different robots or models."""

    code = 504


class ExtendedModelError(DataSetError):
    """A file of an extended model cannot be read or used."""

    code = 505
