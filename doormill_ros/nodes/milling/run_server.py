"""Runs as goals of the action mill_door: one at a time, noted on disk, told to everybody as they end."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

from rclpy.action import CancelResponse
from rclpy.callback_groups import CallbackGroup

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import RunResult
from doormill_ros.cell.errors import CellBusyError, NodeInactiveError, WrongGoalError
from doormill_ros.cell.graph.node_names import DOOR_SHARES
from doormill_ros.cell.run.clock import Clock
from doormill_ros.cell.run.run import Run, RunDesk, StageLimits
from doormill_ros.cell.run.run_in_hand import RunNote
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.convert.run_end import run_end_into
from doormill_ros.nodes.milling.action_server import MillDoorActionServer
from doormill_ros.pipeline.run_end import RunEnd
from doormill_ros.units import ns_to_s

Tell = Callable[[str, float], None]  #: stage and share of the run that is done, 0..1


class RunServer:
    """Serves one goal at a time; a second one is answered, not queued.

    The action is offered for as long as the node lives, so that a refused goal always gets an answer.

    Args:
        node: Owner, with the parameters `limit.*`.
        mill: Takes the run of a goal through its course and says how it ended; what it raises ends the run.
        group: Lets goals, cancellations and answers come at once.
        ended: Called with the reason when a run came to nothing, before anybody is told.
        told: Called with the end of a run that everybody was told.
        was_set: Called in a run when the clock was set, with by how much [s].

    Attributes:
        desk: Has the run in hand.
    """

    def __init__(
        self,
        node: ManagedNode,
        mill: Callable[[Run, Tell], RunEnd],
        group: CallbackGroup,
        *,
        told: Callable[[RunEnd], None],
        ended: Callable[[str], None] = lambda reason: None,
        was_set: Callable[[float], None] = lambda step: None,
    ) -> None:
        self._node, self._mill, self._ended, self._told = node, mill, ended, told
        self._shared = False
        self._note: RunNote | None = None
        self.desk = RunDesk(Clock(wall=lambda: ns_to_s(node.get_clock().now().nanoseconds), was_set=was_set))
        self._result = node.create_publisher(
            topics.RUN_RESULT.type, topics.RUN_RESULT.name, topics.RUN_RESULT.offered
        )
        self._server = MillDoorActionServer(node, self._execute, self._cancel, group)

    def open(self, notes: Path, shared: bool = False) -> RunEnd | None:
        """Take goals from now on.

        Args:
            notes: Folder that keeps a note of the run in hand, for after a restart.
            shared: Goals name the run of which a share is asked for.

        Returns:
            The run that a former process had in hand, without its end; None where there is none.
        """
        self._shared, self._note = shared, RunNote(notes)
        cut_off = self._note.read()
        return None if cut_off is None else RunEnd(*cut_off)

    def leave_to_another(self, silent: bool) -> None:
        """Let another server of this name answer, or answer again."""
        self._server.silent = silent

    def limits(self) -> StageLimits:
        """How long a run waits for each stage, as the node's parameters say."""
        return StageLimits(**{f.name: self._node.value(f"limit.{f.name}") for f in fields(StageLimits)})

    def tell(self, end: RunEnd) -> bool:
        """Tell everybody how a run ended; False where that is left to the next process, as this one is ending."""
        if not self._node.heard:
            self._node.get_logger().info(
                f"door {end.door_id}: /{self._node.get_name()} ends in the middle of run {end.run_id}; the next one "
                "tells of it"
            )
            return False
        message = run_end_into(end, RunResult)
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._result.publish(message)
        self._told(end)
        self._forget()
        return True

    def destroy(self) -> None:
        """Take the action away for good: it latches the states of its goals."""
        self._server.destroy()

    def _forget(self) -> None:
        """A run that ended is no run in hand."""
        if self._note is not None:  # a node that was never configured has none
            with suppress(OSError):  # it is told again after a restart, that is all
                self._note.clear()

    def _cancel(self, goal: Any) -> CancelResponse:
        self.desk.cancel()
        return CancelResponse.ACCEPT

    def _execute(self, goal: Any) -> MillDoor.Result:
        try:
            run = self.desk.begin(goal.request.door_id, goal.request.run_id)
        except CellBusyError as error:
            goal.abort()
            return MillDoor.Result(error_code=error.code, message=error.message)

        def tell(stage: str, progress: float) -> None:
            goal.publish_feedback(MillDoor.Feedback(stage=stage, progress=progress))

        try:
            end = self._course(run, goal.request, tell)
            if not end.milled:
                self._ended(end.message)
            if self._server.silent:
                self._forget()
            else:
                self.tell(end)
            return self._server.end(goal, end)
        finally:  # not before: giving this run up would give up the next one
            self.desk.end()

    def _course(self, run: Run, request: MillDoor.Goal, tell: Tell) -> RunEnd:
        try:
            self._check(request)
            if self._note is not None:
                self._note.write(run.run_id, run.door_id)
            return self._mill(run, tell)
        except Exception as unexpected:  # whatever it is, whoever sent the goal waits for an answer
            error = self._node.as_refusal(unexpected)
            end = RunEnd(run.run_id, run.door_id)
            end.refuse(error.code, error.message)
            return end

    def _check(self, request: MillDoor.Goal) -> None:
        """Refuse a goal while the node rests, and one that is not meant for it."""
        name = self._node.get_name()
        if not self._node.active or self._note is None:
            raise NodeInactiveError(
                f"/{name} is not active; activate it (ros2 lifecycle set /{name} activate)"
            )
        if self._shared and not request.run_id:
            raise WrongGoalError(
                f"door {request.door_id} was refused: this robot mills shares of runs, and the goal names no run; send "
                f"the goal to mill_door of the cell, served by /{DOOR_SHARES}"
            )
        if request.run_id and not self._shared:
            raise WrongGoalError(
                f"door {request.door_id} was refused: whole doors are milled here, and the goal asks for a share of "
                f"run {request.run_id}; leave the run out"
            )
