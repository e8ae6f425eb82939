"""What inspected doors say of the robot's model."""

from __future__ import annotations

from dataclasses import asdict

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorError, MeasureNext, ModelCause, ModelVerdict
from doormill_ros.diagnosis.parts.telling.next_step import NextStep
from doormill_ros.monitor.finding import NamedFault
from doormill_ros.monitor.watch_state import WatchState
from doormill_ros.operator.views.model_view import ModelView, TrendDoor


def verdict_of_model(state: WatchState, header: Header) -> ModelVerdict:
    """The state of the watch as a message."""
    message = ModelVerdict(
        header=header,
        version=state.version,
        proposed=state.proposed,
        expected_error=state.expected,
        expected_error_proposed=state.expected_proposed,
        limit=state.limit,
        stopped=bool(state.stopped),
        waiting=state.waiting,
        asking=state.asking,
        error_code=state.error_code,
        message="; ".join(text for text in (state.stopped, state.message) if text),
        doors=[
            DoorError(
                run_id=door.run_id,
                door_id=door.door_id,
                model_version=door.model_version,
                rms=door.rms,
                largest=door.largest,
            )
            for door in state.doors
        ],
    )
    finding = state.finding
    if finding is not None:
        message.sentence, message.verdict = finding.sentence, finding.verdict
        message.causes = [ModelCause(**asdict(fault)) for fault in finding.faults]
        message.remarks = list(finding.remarks)
        message.next_measurement = finding.next_measurement
        message.next = [MeasureNext(**asdict(step)) for step in finding.next_steps]
        message.questioned = finding.questioned
    return message


def faults_of(message: ModelVerdict) -> tuple[NamedFault, ...]:
    """The causes of a verdict."""
    return tuple(NamedFault(c.cause, c.where, c.course, c.from_run, c.from_door) for c in message.causes)


def steps_of(message: ModelVerdict) -> tuple[NextStep, ...]:
    """What a verdict says to measure next."""
    return tuple(
        NextStep(n.step, n.cause, n.other, n.by, n.points, n.feature, n.recipe) for n in message.next
    )


def view_of_model(message: ModelVerdict) -> ModelView:
    """A verdict as the operator's page shows it."""
    return ModelView(
        message.sentence,
        message.next_measurement,
        tuple(message.remarks),
        message.version,
        message.proposed,
        message.expected_error,
        message.expected_error_proposed,
        message.limit,
        message.stopped,
        message.message,
        message.asking,
        message.waiting,
        tuple(TrendDoor(d.door_id, d.run_id, d.model_version, d.largest) for d in message.doors),
        message.verdict,
        faults_of(message),
        message.questioned,
        steps_of(message),
        message.error_code,
    )
