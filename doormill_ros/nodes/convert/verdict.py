"""What inspected doors say of the robot's model."""

from __future__ import annotations

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorError, ModelCause, ModelVerdict
from doormill_ros.monitor.watch import WatchState


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
        message.causes = [
            ModelCause(
                cause=fault.cause,
                where=fault.where,
                course=fault.course,
                from_run=fault.from_run,
                from_door=fault.from_door,
            )
            for fault in finding.faults
        ]
        message.remarks = list(finding.remarks)
        message.next_measurement = finding.next_measurement
        message.questioned = finding.questioned
    return message
