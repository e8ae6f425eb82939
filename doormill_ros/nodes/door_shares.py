"""Node /door_shares: serves mill_door in a cell with two robots and asks the bridge of each for its share."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from std_msgs.msg import Bool

from doormill_interfaces.msg import DoorRecipe
from doormill_ros.cell.errors import RunCutOffError
from doormill_ros.cell.graph.node_names import DOOR_SHARES
from doormill_ros.cell.run.run import Run
from doormill_ros.messages.from_message import recipe_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.base.robots import ROBOTS
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER, DoorInspections
from doormill_ros.nodes.milling.limit_parameters import limit_parameters
from doormill_ros.nodes.milling.recipe_client import RecipeClient
from doormill_ros.nodes.milling.run_server import RunServer, Tell
from doormill_ros.nodes.milling.share_client import ShareClient
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.pipeline.run_end import RunEnd
from doormill_ros.pipeline.shared_course import SharedCourse
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split


class DoorShares(ManagedNode):
    """Takes a door through the run that both robots share; says when the camera looks and which robot may mill."""

    PARAMETERS = (
        GAUGE_PARAMETER,
        NodeParameter(
            "note", "out/targets", "folder that keeps a note of the run in hand, for after a restart"
        ),
        *limit_parameters(),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(DOOR_SHARES, **kwargs)
        self._group = ReentrantCallbackGroup()
        self._runs = RunServer(self, self._mill, self._group, told=self._report_end)

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
        cut_off = self._runs.open(Path(self.value("note")))
        if cut_off is not None:
            self._end_what_was_cut_off(cut_off)

    def _end_what_was_cut_off(self, end: RunEnd) -> None:
        """Tell how the run ended that a former process of this node had in hand."""
        end.refuse(
            RunCutOffError.code,
            f"/{DOOR_SHARES} ended in the middle of the run and was started again; see that both robots stand still, "
            "look at the door, start again",
        )
        self._runs.tell(end)

    def stop(self) -> None:
        """Give up the run in hand; the robots do so with their shares."""
        self._runs.desk.cancel()

    def destroy_node(self) -> None:
        """Take the action away too."""
        self._runs.destroy()
        super().destroy_node()

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
        self._runs.desk.notify()

    def _mill(self, run: Run, tell: Tell) -> RunEnd:
        workers, limits = partial(self._workers, run.run_id), self._runs.limits()
        return SharedCourse(run, self._recipes, self._robots, workers, self._inspections, limits, tell).mill()

    def _report_end(self, end: RunEnd) -> None:
        self.report(OK if end.success else WARN, end.message, error_code=end.error_code)


def main() -> int:
    """Run the node."""
    return run_nodes(DoorShares)


if __name__ == "__main__":
    sys.exit(main())
