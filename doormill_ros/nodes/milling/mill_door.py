"""The action mill_door: its goals, feedback and results; what happens in between is the course of the run."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

from rclpy.action import CancelResponse
from rclpy.callback_groups import CallbackGroup

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import RunResult
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.cell.clock import Clock, step_text
from doormill_ros.cell.errors import CellBusyError, NodeInactiveError, RunCutOffError, WrongGoalError
from doormill_ros.cell.inspection import MeasuredDoor
from doormill_ros.cell.node_names import ABB_BRIDGE, DOOR_SHARES
from doormill_ros.cell.run import RunDesk, StageLimits
from doormill_ros.cell.run_in_hand import RunNote
from doormill_ros.errors import DoormillError
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.reporting_node import WARN
from doormill_ros.nodes.convert.run_end import run_end_into
from doormill_ros.nodes.milling.action_server import MillDoorActionServer
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER, DoorInspections
from doormill_ros.nodes.milling.recipe_client import RecipeClient
from doormill_ros.pipeline.course import Course
from doormill_ros.pipeline.partners import Attendance, Handover
from doormill_ros.pipeline.run_end import RunEnd
from doormill_ros.units import ns_to_s


class MillDoorServer:
    """Serves one goal at a time; a second one is answered, not queued.

    The action is offered for as long as the node lives, so that a refused goal always gets an answer.

    Args:
        node: Owner, with the parameters `limit.*`.
        handover: The link to the controller; asked for anything only while the node is active.
        give_up: Called with the reason when a run came to nothing.
        group: Lets goals, cancellations and answers come at once.
    """

    def __init__(
        self,
        node: ManagedNode,
        handover: Handover,
        give_up: Callable[[str], None],
        group: CallbackGroup,
    ) -> None:
        self._shared = False
        self._word = ""  # run of which the share may be milled
        self._node = node
        self._handover = handover
        self._give_up = give_up
        self._group = group
        self._desk = RunDesk(
            Clock(wall=lambda: ns_to_s(node.get_clock().now().nanoseconds), was_set=self._tell_of_step)
        )
        self._recipes: RecipeClient | None = None
        self._inspections: DoorInspections | None = None
        self._attendance: Attendance | None = None
        self._cut_off: RunEnd | None = None
        self._note: RunNote | None = None
        self._ending = threading.Lock()
        self._result = node.create_publisher(
            topics.RUN_RESULT.type, topics.RUN_RESULT.name, topics.RUN_RESULT.offered
        )
        self._server = MillDoorActionServer(node, self._execute, self._cancel, group)

    def leave_to_another(self, silent: bool) -> None:
        """Let another server of this name answer, or answer again."""
        self._server.silent = silent

    def open(self, attendance: Attendance, sensors: Sequence[str], shared: bool) -> None:
        """Connect to the recipe database and to who measures milled doors.

        Args:
            attendance: Which nodes are alive.
            sensors: What finds the doors.
            shared: The robot mills a share of each door, in runs of /door_shares alone.
        """
        self._shared = shared
        self._attendance = attendance
        self._sensors = tuple(sensors)
        note = self._note = RunNote(Path(self._node.value("archive")))
        self._recipes = RecipeClient(self._node, self._group)
        self._inspections = DoorInspections(self._node, self.notify, self._node.value(GAUGE_PARAMETER.name))
        cut_off = note.read()
        self._cut_off = None if cut_off is None else RunEnd(*cut_off)
        self._end_what_was_cut_off()

    def _end_what_was_cut_off(self) -> None:
        """Tell how the run ended that a former process of this bridge had in hand, as soon as that is known."""
        with self._ending:
            end, handshake, inspections = self._cut_off, self._handover.handshake, self._inspections
            if end is None or handshake.snapshot.state is HandshakeState.CLEARING:
                return
            outcome = handshake.outcome(end.run_id)
            if outcome is not None and outcome.milled is None:
                return  # the robot mills it still
            self._cut_off = None
        if outcome is None:
            end.refuse(
                RunCutOffError.code,
                "the bridge ended in the middle of the run and was started again; see that the robot stands still, "
                "look at the door, start again",
            )
        elif outcome.milled:
            found = None if inspections is None else inspections.found(end.run_id)
            end.mill_unseen(found or MeasuredDoor())
        else:
            end.refuse(MillingFaultError.code, outcome.reason)
        if self._tell(end):
            self._clear_note()

    def _clear_note(self) -> None:
        if self._note is not None:  # a bridge that was never configured has none
            self._note.clear()

    def close(self) -> None:
        """Disconnect."""
        self.cancel()
        if self._recipes is not None:
            self._recipes.close()
        self._recipes = None

    def destroy(self) -> None:
        """Take the action away for good."""
        self._server.destroy()

    def deliver(self, stage: str, message: Any) -> bool:
        """Pass a stage's answer to the run in hand; False when it belongs to no run of this server."""
        return self._desk.deliver(stage, message.run_id, message, seconds_of(message.header.stamp))

    def give_word(self, run_id: str) -> None:
        """The share of that run may be milled."""
        self._word = run_id
        self._desk.notify()

    def notify(self) -> None:
        """The handshake changed."""
        self._desk.notify()
        self._end_what_was_cut_off()

    def cancel(self) -> None:
        """End the run in hand, if any."""
        self._desk.cancel()

    def _cancel(self, goal: Any) -> CancelResponse:
        self.cancel()
        return CancelResponse.ACCEPT

    def _execute(self, goal: Any) -> MillDoor.Result:
        try:
            run = self._desk.begin(goal.request.door_id, goal.request.run_id)
        except CellBusyError as error:
            goal.abort()
            return MillDoor.Result(error_code=error.code, message=error.message)
        end = RunEnd(run.run_id, run.door_id)

        def tell(stage: str, progress: float) -> None:
            goal.publish_feedback(MillDoor.Feedback(stage=stage, progress=progress))

        try:
            recipes, inspections, attendance = self._recipes, self._inspections, self._attendance
            note = self._note
            if not self._node.active or not (recipes and inspections and attendance and note):
                raise NodeInactiveError(
                    "the ABB bridge is not active; activate it (ros2 lifecycle set /abb_bridge activate)"
                )
            if self._shared != bool(goal.request.run_id):
                server = DOOR_SHARES if self._shared else ABB_BRIDGE
                raise WrongGoalError(
                    f"door {goal.request.door_id} was refused: this robot mills "
                    + (
                        "shares of runs, and the goal names no run"
                        if self._shared
                        else "whole doors, and the goal asks for a share"
                    )
                    + f"; send the goal to mill_door of the cell, served by /{server}"
                )
            note.write(run.run_id, run.door_id)
            partners = recipes, self._handover, inspections, attendance
            word = (lambda: self._word == run.run_id) if self._shared else None
            course = Course(run, *partners, self._limits(), tell, self._sensors, word)
            end = course.end
            course.mill()
        except DoormillError as error:
            end.refuse(error.code, error.message)
        except Exception as error:
            if self._node.heard:  # else it is the way out that it met
                self._node.get_logger().error(f"run {run.run_id} ended by {type(error).__name__}: {error}")
            end.refuse(DoormillError.code, f"{type(error).__name__}: {error}; see the bridge's log")
        try:
            return self._finish(end, goal)
        finally:  # not before: giving this run up would give up the next one
            self._desk.end()

    def _tell_of_step(self, step: float) -> None:
        said = f"{step_text(step)} in the middle of a run; stamps of before count no more"
        self._node.report(WARN, said)
        self._node.get_logger().warning(said)

    def _limits(self) -> StageLimits:
        names = [field.name for field in fields(StageLimits)]
        return StageLimits(**{name: self._node.value(f"limit.{name}") for name in names})

    def _finish(self, end: RunEnd, goal: Any) -> MillDoor.Result:
        """Tell everybody how the run ended; the note stays where nobody could be told."""
        if not end.milled:
            self._give_up(end.message)
        if self._server.silent or self._tell(end):
            with suppress(OSError):  # it is told again after a restart, that is all
                self._clear_note()
        return self._server.end(goal, end)

    def _tell(self, end: RunEnd) -> bool:
        """Tell everybody how a run ended; False where that is left to the next process, as this one is ending."""
        log = self._node.get_logger()
        if not self._node.heard:
            log.info(
                f"door {end.door_id}: this bridge ends in the middle of run {end.run_id}; the next one tells of it"
            )
            return False
        message = run_end_into(end, RunResult)
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._result.publish(message)
        # rclpy ties a severity to the line that logs.
        if end.success:
            log.info(end.message)
        else:
            log.warning(end.message)
        return True
