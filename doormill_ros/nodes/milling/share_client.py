"""Part of /door_shares: one of the two robots, asked for its share through the action of its bridge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

from rclpy.callback_groups import CallbackGroup
from std_msgs.msg import Bool, String

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import RunResult
from doormill_ros.cell.errors import NodeDeadError
from doormill_ros.cell.graph.topic_names import SHARE_RESULT
from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.cell.output.summary import StageDurations
from doormill_ros.cell.run.run import TARGETS
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.alive import LEASE, AliveWatch
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.clients.goal_client import GoalClient


class ShareClient:
    """A robot as the run sees it (`pipeline.shared_course.ShareRobot`).

    Args:
        node: Owner; make this in its `setup`.
        name: "first" or "second".
        notify: Called after each change.
        group: Lets answers come while a goal is executed.
    """

    def __init__(
        self, node: ManagedNode, name: str, notify: Callable[[], None], group: CallbackGroup
    ) -> None:
        self.name = name
        self._notify = notify
        self._run_id = ""
        self._stage = ""
        self._canceled = False
        self._goal: Any = None
        self.end: RunResult | MillDoor.Result | None = None
        self.request = self.ready = False
        place = in_robot(name)
        self._bridge = node.resolve_topic_name(f"{place}/_alive/abb_bridge")
        self._alive = AliveWatch(node, (self._bridge,), notify)
        self._action = GoalClient(node, MillDoor, f"{place}/mill_door", callback_group=group)
        node.keep(lambda action: action.destroy(), self._action)
        self._go = node.publisher(topics.at(topics.SHARE_GO, place))
        node.subscribe(topics.at(topics.RUN_RESULT, place, SHARE_RESULT), self._take_result)
        node.subscribe(topics.at(topics.ABB_REQUEST, place), self._take_request)
        node.subscribe(topics.at(topics.ABB_READY, place), self._take_ready)

    @property
    def present(self) -> bool:
        """See `ShareRobot`."""
        return bool(self._action.server_is_ready())

    @property
    def planned(self) -> bool:
        """See `ShareRobot`."""
        return self._stage == TARGETS  # of which a bridge tells when it waits for the word

    def begin(self, door_id: str, run_id: str) -> None:
        """See `ShareRobot`."""
        self._run_id, self._stage, self._canceled = run_id, "", False
        self._goal = self.end = None
        goal = MillDoor.Goal(door_id=door_id, run_id=run_id)
        sent = self._action.send_goal_async(goal, self._take_feedback)
        sent.add_done_callback(self._take_goal)

    def give_word(self, run_id: str) -> None:
        """See `ShareRobot`."""
        self._go.publish(String(data=run_id))

    def cancel(self) -> None:
        """See `ShareRobot`."""
        self._canceled = True
        if self._goal is not None:
            self._goal.cancel_goal_async()

    def require(self) -> None:
        """See `ShareRobot`."""
        if self._alive.dead((self._bridge,)):
            raise NodeDeadError(
                f"the bridge of the {self.name} robot is dead: it gave no sign of life for {LEASE:g} s; see that both "
                "robots stand still, and when it runs again, start the door again"
            )

    def times(self) -> StageDurations:
        """See `ShareRobot`."""
        if self.end is None:
            return StageDurations()
        return StageDurations(**{f.name: getattr(self.end.times, f.name) for f in fields(StageDurations)})

    def _take_goal(self, sent: Any) -> None:
        self._goal = sent.result()
        self._goal.get_result_async().add_done_callback(lambda future: self._finish(future.result().result))
        if self._canceled:
            self.cancel()

    def _take_feedback(self, message: Any) -> None:
        self._stage = message.feedback.stage
        self._notify()

    def _take_result(self, message: RunResult) -> None:
        # What a bridge tells that was started again in the middle of a run is no answer to the goal.
        if message.run_id == self._run_id:
            self._finish(message)

    def _finish(self, end: RunResult | MillDoor.Result) -> None:
        if self.end is None and end.run_id in ("", self._run_id):
            self.end = end
            self._notify()

    def _take_request(self, message: Bool) -> None:
        self.request = message.data
        self._notify()

    def _take_ready(self, message: Bool) -> None:
        self.ready = message.data
        self._notify()
