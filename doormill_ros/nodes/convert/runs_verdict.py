"""What the bags of the last runs say of the cell."""

from __future__ import annotations

from dataclasses import asdict

from std_msgs.msg import Header

from doormill_interfaces.msg import CellChange as CellChangeMessage
from doormill_interfaces.msg import ChangeSize as ChangeSizeMessage
from doormill_interfaces.msg import RunsVerdict
from doormill_ros.monitor.cell_change import CellChange, ChangeSize
from doormill_ros.monitor.runs_watch import RunsState
from doormill_ros.operator.views.runs_view import RunsView


def verdict_of_runs(state: RunsState, header: Header) -> RunsVerdict:
    """The state of the watch over bags as a message."""
    message = RunsVerdict(
        header=header,
        since=state.since,
        asking=state.asking,
        error_code=state.error_code,
        message=state.message,
    )
    found = state.finding
    if found is not None:
        message.sentence, message.verdict = found.sentence, found.verdict
        message.changes = [_message_of(change) for change in found.changes]
        message.next_measurement = found.next_measurement
        message.questioned, message.runs = found.questioned, list(found.runs)
        message.left_aside, message.remarks = list(found.left_aside), list(found.remarks)
    return message


def view_of_runs(message: RunsVerdict) -> RunsView:
    """What the operator's page shows of a verdict."""
    return RunsView(
        message.sentence,
        message.verdict,
        changes_of_runs(message),
        message.questioned,
        message.next_measurement,
        tuple(message.left_aside),
        message.asking,
        message.error_code,
        message.message,
    )


def changes_of_runs(message: RunsVerdict) -> tuple[CellChange, ...]:
    """The changes of a verdict."""
    return tuple(
        CellChange(
            change.cause,
            change.where,
            change.course,
            change.from_run,
            change.earliest,
            change.latest,
            tuple(ChangeSize(size.name, size.value, size.unit) for size in change.sizes),
            tuple(change.tied_with),
        )
        for change in message.changes
    )


def _message_of(change: CellChange) -> CellChangeMessage:
    sizes = [ChangeSizeMessage(**asdict(size)) for size in change.sizes]
    return CellChangeMessage(**{**asdict(change), "sizes": sizes, "tied_with": list(change.tied_with)})
