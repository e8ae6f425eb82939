"""Errors of robot models that were written to a file.

DataSetError 500
|-- ExtendedModelError 505  a model.yaml cannot be used
`-- PoseModelError 512      a model.yaml of a pose diagnosis cannot be used
"""

from __future__ import annotations

from doormill_ros.errors import DataSetError


class ExtendedModelError(DataSetError):
    """A file of an extended model cannot be read or used."""

    code = 505


class PoseModelError(DataSetError):
    """A model.yaml of a pose diagnosis cannot be read or used."""

    code = 512
