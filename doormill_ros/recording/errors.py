"""What can be wrong with a bag."""

from __future__ import annotations

from doormill_ros.errors import DoormillError


class BagError(DoormillError):
    """Base of all bag errors."""


class UnknownTypeError(BagError):
    """A message type has no definition in the ament index."""

    code = 602


BagExistsError = BagError.row("BagExistsError", 601, "The folder to record into holds something already.")
UnreadableBagError = BagError.row("UnreadableBagError", 603, "The bag is not there or is beyond reading.")
EmptyBagError = BagError.row("EmptyBagError", 604, "The bag lacks what was asked of it.")
BadExpectationError = BagError.row(
    "BadExpectationError", 605, "The file with what a replay must give is not of its form."
)
BadTimelineError = BagError.row("BadTimelineError", 606, "The timeline of reference bags is not of its form.")
AcceptedBagError = BagError.row(
    "AcceptedBagError", 607, "No bag is accepted yet, or one cannot be put to the accepted ones."
)
SharedRunError = BagError.row(
    "SharedRunError", 608, "A run of two robots, which nodes cannot be asked to repeat."
)
IncompleteBagError = BagError.row(
    "IncompleteBagError", 609, "A bag lacks messages that it should hold, or the end of a run."
)
BagEndError = BagError.row("BagEndError", 610, "The end of a bag cannot be written.")
