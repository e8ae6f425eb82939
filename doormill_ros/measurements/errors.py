"""Errors of measured data and of what is made from them.

DataSetError 500           doormill_ros.errors
|-- DataFileError 501        a file of the set is missing or is no text
|-- SetDescriptionError 502  set.yaml lacks something or holds an impossible value
|-- TrialTableError 503      trials.csv has a cell or column that cannot be used
|-- SetMixError 504          sets given together do not belong together
|-- PoseTableError 510       poses.csv has a cell or column that cannot be used
`-- PosePlacementError 511   too few rows to place a set in front of the tracker
"""

from __future__ import annotations

from doormill_ros.errors import DataSetError


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


class PoseTableError(DataSetError):
    """poses.csv has a column or cell that cannot be used."""

    code = 510


class PosePlacementError(DataSetError):
    """Too few rows, or too much alike, to find base-in-tracker and target-in-flange."""

    code = 511
