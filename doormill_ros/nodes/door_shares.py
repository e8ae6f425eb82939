"""Node /door_shares: serves mill_door in a cell with two robots and asks the bridge of each for its share."""

from __future__ import annotations

import sys
from contextlib import suppress
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.action import CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from std_msgs.msg import Bool

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import DoorRecipe, RunResult
from doormill_ros.cell.clock import Clock
from doormill_ros.cell.errors import CellBusyError, NodeInactiveError, RunCutOffError
from doormill_ros.cell.node_names import DOOR_SHARES
from doormill_ros.cell.run import Run, RunDesk, StageLimits
from doormill_ros.cell.run_in_hand import RunNote
from doormill_ros.messages.from_message import recipe_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.reporting_node import OK, WARN, NodeParameter
from doormill_ros.nodes.base.robots import ROBOTS
from doormill_ros.nodes.convert.run_end import run_end_into
from doormill_ros.nodes.milling.action_server import MillDoorActionServer
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER, DoorInspections
from doormill_ros.nodes.milling.recipe_client import RecipeClient
from doormill_ros.nodes.milling.share_client import ShareClient
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.pipeline.run_end import RunEnd
from doormill_ros.pipeline.shared_course import SharedCourse
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split
from doormill_ros.units import ns_to_s


class DoorShares(ManagedNode):
    """Takes a door through the run that both robots share; says when the camera looks and which robot may mill."""

    PARAMETERS = (
        GAUGE_PARAMETER,
        NodeParameter(
            "note", "out/targets", "folder that keeps a note of the run in hand, for after a restart"
        ),
        *(
            NodeParameter(
                f"limit.{field.name}",
                field.default,
                f"longest wait of a robot for {field.name} [s]",
                0.1,
                36000.0,
                live=True,
            )
            for field in fields(StageLimits)
        ),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(DOOR_SHARES, **kwargs)
        self._group = ReentrantCallbackGroup()
        self._note: RunNote | None = None
        self._desk = RunDesk(Clock(wall=lambda: ns_to_s(self.get_clock().now().nanoseconds)))
        self._result = self.create_publisher(
            topics.RUN_RESULT.type, topics.RUN_RESULT.name, topics.RUN_RESULT.offered
        )
        self._server = MillDoorActionServer(self, self._execute, self._cancel, self._group)

    def setup(self) -> None:
        """Reach for robots, recipes and inspections."""
        self._settings = load_settings()
        self._in_hand: tuple[str, tuple[str, ...] | None] = ("", None)  # run and who works in it
        self._shown: tuple[bool, bool] | None = None
        self._request = self.publisher(topics.ABB_REQUEST)
        self._ready = self.publisher(topics.ABB_READY)
        self._robots = tuple(ShareClient(self, name, self._notify, self._group) for name in ROBOTS)
        self._recipes = RecipeClient(self, self._group)
        self.keep(lambda recipes: recipes.close(), self._recipes)
        self._inspections = DoorInspections(self, self._notify, self.value(GAUGE_PARAMETER.name))
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        note = self._note = RunNote(Path(self.value("note")))
        cut_off = note.read()
        if cut_off is not None:
            self._end_what_was_cut_off(RunEnd(*cut_off))

    def _end_what_was_cut_off(self, end: RunEnd) -> None:
        """Tell how the run ended that a former process of this node had in hand."""
        end.refuse(
            RunCutOffError.code,
            f"/{DOOR_SHARES} ended in the middle of the run and was started again; see that both robots stand still, "
            "look at the door, start again",
        )
        self._tell(end)

    def stop(self) -> None:
        """Give up the run in hand; the robots do so with their shares."""
        self._desk.cancel()

    def destroy_node(self) -> None:
        """Take the action away too: it latches the states of its goals."""
        self._server.destroy()
        super().destroy_node()

    def _cancel(self, goal: Any) -> CancelResponse:
        self._desk.cancel()
        return CancelResponse.ACCEPT

    def _take_recipe(self, message: DoorRecipe) -> None:
        shares = split(recipe_of(message), np.eye(4), self._settings)
        self._in_hand = message.run_id, tuple(share.robot for share in shares if share.operations)
        self._notify()

    def _workers(self, run_id: str) -> tuple[str, ...] | None:
        """Who has something to mill in a run; None while its recipe has not come."""
        of_run, workers = self._in_hand
        return workers if of_run == run_id else None

    def _notify(self) -> None:
        """Something changed: the camera looks when every robot that mills asks for targets."""
        workers = self._in_hand[1] or ROBOTS
        working = [robot for robot in self._robots if robot.name in workers]
        shown = all(robot.request for robot in working), any(robot.ready for robot in working)
        if shown != self._shown and self.context.ok():
            self._shown = shown
            self._request.publish(Bool(data=shown[0]))
            self._ready.publish(Bool(data=shown[1]))
        self._desk.notify()

    def _execute(self, goal: Any) -> MillDoor.Result:
        try:
            run = self._desk.begin(goal.request.door_id)
        except CellBusyError as error:
            goal.abort()
            return MillDoor.Result(error_code=error.code, message=error.message)
        try:
            return self._finish(self._mill(run, goal), goal)
        finally:
            self._desk.end()

    def _mill(self, run: Run, goal: Any) -> RunEnd:
        def tell(stage: str, progress: float) -> None:
            goal.publish_feedback(MillDoor.Feedback(stage=stage, progress=progress))

        try:
            if not self.active or self._note is None:
                raise NodeInactiveError(
                    f"/{DOOR_SHARES} is not active; activate it (ros2 lifecycle set /{DOOR_SHARES} activate)"
                )
            self._note.write(run.run_id, run.door_id)
            limits = StageLimits(**{f.name: self.value(f"limit.{f.name}") for f in fields(StageLimits)})
            workers = partial(self._workers, run.run_id)
            return SharedCourse(
                run, self._recipes, self._robots, workers, self._inspections, limits, tell
            ).mill()
        except Exception as unexpected:  # whatever it is, whoever sent the goal waits for an answer
            error = self.as_refusal(unexpected)
            end = RunEnd(run.run_id, run.door_id)
            end.refuse(error.code, error.message)
            return end

    def _finish(self, end: RunEnd, goal: Any) -> MillDoor.Result:
        self._tell(end)
        return self._server.end(goal, end)

    def _tell(self, end: RunEnd) -> None:
        """Tell everybody how a run ended; the note stays where nobody can be told any more."""
        if not self.heard:
            return
        message = run_end_into(end, RunResult)
        message.header.stamp = self.get_clock().now().to_msg()
        self._result.publish(message)
        if self._note is not None:
            with suppress(OSError):  # it is told again after a restart, that is all
                self._note.clear()
        self.report(OK if end.success else WARN, end.message, error_code=end.error_code)


def main() -> int:
    """Run the node."""
    return run_nodes(DoorShares)


if __name__ == "__main__":
    sys.exit(main())
