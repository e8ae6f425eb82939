"""The runs of /abb_bridge: what they need and what is delivered to them; the rest is the course of a run."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from rclpy.callback_groups import CallbackGroup

from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.cell.errors import NodeInactiveError, RunCutOffError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.run.clock import step_text
from doormill_ros.cell.run.run import Run
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.reporting_node import WARN
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER, DoorInspections
from doormill_ros.nodes.milling.recipe_client import RecipeClient
from doormill_ros.nodes.milling.run_server import RunServer, Tell
from doormill_ros.pipeline.course import Course
from doormill_ros.pipeline.partners import Attendance, Handover
from doormill_ros.pipeline.run_end import RunEnd


class MillDoorServer:
    """Takes doors through their runs with one robot.

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
        self._group = group
        self._recipes: RecipeClient | None = None
        self._inspections: DoorInspections | None = None
        self._attendance: Attendance | None = None
        self._cut_off: RunEnd | None = None
        self._ending = threading.Lock()
        self._runs = RunServer(
            node, self._mill, group, told=self._log, ended=give_up, was_set=self._tell_of_step
        )

    def leave_to_another(self, silent: bool) -> None:
        """Let another server of this name answer, or answer again."""
        self._runs.leave_to_another(silent)

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
        self._recipes = RecipeClient(self._node, self._group)
        self._inspections = DoorInspections(self._node, self.notify, self._node.value(GAUGE_PARAMETER.name))
        self._cut_off = self._runs.open(Path(self._node.value("archive")), shared)
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
            end.note_unseen_milling(found or MeasuredDoor())
        else:
            end.refuse(MillingFaultError.code, outcome.reason)
        self._runs.tell(end)

    def close(self) -> None:
        """Disconnect."""
        self.cancel()
        if self._recipes is not None:
            self._recipes.close()
        self._recipes = None

    def destroy(self) -> None:
        """Take the action away for good."""
        self._runs.destroy()

    def deliver(self, stage: str, message: Any) -> bool:
        """Pass a stage's answer to the run in hand; False when it belongs to no run of this server."""
        return self._runs.desk.deliver(stage, message.run_id, message, seconds_of(message.header.stamp))

    def give_word(self, run_id: str) -> None:
        """The share of that run may be milled."""
        self._word = run_id
        self._runs.desk.notify()

    def notify(self) -> None:
        """The handshake changed."""
        self._runs.desk.notify()
        self._end_what_was_cut_off()

    def cancel(self) -> None:
        """End the run in hand, if any."""
        self._runs.desk.cancel()

    def _mill(self, run: Run, tell: Tell) -> RunEnd:
        recipes, inspections, attendance = self._recipes, self._inspections, self._attendance
        if not (recipes and inspections and attendance):
            raise NodeInactiveError("the ABB bridge was cleaned up; configure and activate it")
        word = (lambda: self._word == run.run_id) if self._shared else None
        partners = recipes, self._handover, inspections, attendance
        return Course(run, *partners, self._runs.limits(), tell, self._sensors, word).mill()

    def _tell_of_step(self, step: float) -> None:
        said = f"{step_text(step)} in the middle of a run; stamps of before count no more"
        self._node.report(WARN, said)
        self._node.get_logger().warning(said)

    def _log(self, end: RunEnd) -> None:
        log = self._node.get_logger()
        # rclpy ties a severity to the line that logs.
        if end.success:
            log.info(end.message)
        else:
            log.warning(end.message)
