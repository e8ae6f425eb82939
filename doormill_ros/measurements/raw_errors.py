"""What can be wrong with loading tests.

DataSetError (500..599)
|-- 580 RawFileError          a tracker or force file that cannot be read: file, line, column
|-- 581 NotSteadyError        a recording without a steady window
|-- 582 LoadingTestError      a loading test file that contradicts its form
`-- 583 IdentifiabilityError  loadings that cannot tell any joint's stiffness
"""

from __future__ import annotations

from doormill_ros.errors import DataSetError


class RawFileError(DataSetError):
    """A laser tracker or force sensor file cannot be read."""

    code = 580


class NotSteadyError(DataSetError):
    """A recording holds no steady window that is long enough."""

    code = 581


class LoadingTestError(DataSetError):
    """A description of loading tests contradicts its form."""

    code = 582


class IdentifiabilityError(DataSetError):
    """The loadings do not tell the stiffness of any joint."""

    code = 583
