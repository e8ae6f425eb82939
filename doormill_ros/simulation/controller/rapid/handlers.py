"""What an ERROR clause decides, and what happens when it does not.

Page numbers are those of "RAPID Reference Manual, Basic Characteristics", yumpu.com 5679047.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop, error_name
from doormill_ros.simulation.controller.rapid.scope import Frame
from doormill_ros.simulation.controller.rapid.types import Value

RETURN, RETRY, TRYNEXT, RERAISE = "RETURN", "RETRY", "TRYNEXT", "RERAISE"
#: How often RETRY may repeat one statement, as the controller is delivered.
RETRY_LIMIT = 4
#: Numbers that a program may raise (pages 110 and 386); BookErrNo gives numbers among them.
OWN_RAISES = range(1, 91)
#: Number of the event that an ERROR clause leaves behind, unless it calls SkipWarn
#: (3HAC050917-001, SkipWarn; the number was not seen).
ERROR_TAKEN = 40000


class Completion(NamedTuple):
    """What a statement hands to the block around it, which then goes no further.

    Attributes:
        word: RETURN, or within an ERROR clause RETRY, TRYNEXT or RERAISE.
        value: What a function returns.
    """

    word: str
    value: Value = None


#: Compiled statements; None means go on with the next one.
Step = Callable[[Frame], Completion | None]


def run_handler(context: Context, handler: Step, frame: Frame, fault: RapidFault) -> Completion:
    """Run the ERROR clause; a fault that it passes on is marked, so that it reaches the caller.

    An error within it, and its end without a decision, stop the program.
    """
    if not fault.file:
        fault.file, fault.line = context.file, context.line
    context.errno[0] = float(fault.number)
    saved, context.warning = context.warning, fault.warning
    try:
        outcome = handler(frame)
    except RapidFault as further:
        # Page 110: nothing takes an error that occurs within an error clause.
        stop = RapidStop(f"{error_name(further.number)}: {further.reason}, within an ERROR clause")
        stop.file, stop.line = further.file, further.line
        raise stop from None
    finally:
        warning, context.warning = context.warning, saved
    if outcome is None:
        raise RapidStop(
            "an ERROR clause ended without RETRY, TRYNEXT, RETURN, RAISE or EXIT; it was called with "
            f"{error_name(fault.number)}: {fault.reason}"
        )
    if outcome.word == RERAISE:
        fault.escaped = frame
        raise fault
    if warning:
        context.machine.log("warning", "error taken", warning, ERROR_TAKEN)
    return outcome
