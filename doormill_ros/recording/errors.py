"""What can be wrong with a bag."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class BagError(DoormillError):
    """Base of all bag errors."""


class BagExistsError(BagError):
    """The folder to record into holds something already."""

    code = 601


class UnknownTypeError(BagError):
    """A message type has no definition in the ament index."""

    code = 602


class UnreadableBagError(BagError):
    """The bag is not there, or damaged beyond reading."""

    code = 603


class EmptyBagError(BagError):
    """The bag lacks what was asked of it."""

    code = 604


class BadExpectationError(BagError):
    """The file beside a bag that says what a replay must give is not of its form."""

    code = 605


class BadTimelineError(BagError):
    """The timeline of reference bags is not of its form."""

    code = 606
