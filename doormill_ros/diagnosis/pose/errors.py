"""Errors of pose sets.

PoseTableError 510         poses.csv has a cell or column that cannot be used
|-- PosePlacementError 511 too few rows to place a set in front of the tracker
`-- PoseModelError 512     a model.yaml of a pose diagnosis cannot be used
"""

from __future__ import annotations

from doormill_ros.diagnosis.errors import DataSetError


class PoseTableError(DataSetError):
    """poses.csv has a column or cell that cannot be used."""

    code = 510


class PosePlacementError(DataSetError):
    """Too few rows, or too much alike, to find base-in-tracker and target-in-flange."""

    code = 511


class PoseModelError(DataSetError):
    """A model.yaml of a pose diagnosis cannot be read or used."""

    code = 512
