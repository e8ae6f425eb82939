"""What the operator's page may do to the cell."""

from __future__ import annotations

from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup

from doormill_interfaces.action import MillDoor
from doormill_interfaces.srv import AcceptModel, ListRecipes, RevertModel
from doormill_ros.cell.errors import CellBusyError, NodeInactiveError, StageRefusedError, StageTimeoutError
from doormill_ros.cell.graph.node_names import ABB_BRIDGE, DOOR_SHARES
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.clients.futures import result_of
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.operator.views.view_store import ViewStore

ACTION = "mill_door"
OFFERED_DOORS = 20
DATABASE_LIMIT = 5.0  # s
MODEL_LIMIT = 10.0  # s


class ActionControl:
    """What the page asks of the action mill_door; called from the web server's threads.

    Args:
        node: Owner; make this in its `setup`.
        store: Tells which run is in hand, and is told what came of a goal that became none.
    """

    def __init__(self, node: ManagedNode, store: ViewStore) -> None:
        self._node = node
        self._store = store
        self._server = DOOR_SHARES if store.view.pair is not None else ABB_BRIDGE
        group = ReentrantCallbackGroup()
        self._goals = node.keep(GoalClient.destroy, GoalClient(node, MillDoor, ACTION, callback_group=group))
        self._recipes = node.keep(
            node.destroy_client, node.create_client(ListRecipes, "recipes/list", callback_group=group)
        )
        self._accepts, self._reverts = (
            node.keep(node.destroy_client, node.create_client(kind, name, callback_group=group))
            for kind, name in ((AcceptModel, "model/accept"), (RevertModel, "model/revert"))
        )
        # With no goal named, the action ends whatever run is in hand, no matter who started it.
        self._cancel = node.keep(
            node.destroy_client,
            node.create_client(
                MillDoor.Impl.CancelGoalService, f"{ACTION}/_action/cancel_goal", callback_group=group
            ),
        )

    def mill(self, door_id: str) -> str:
        """Start milling a door."""
        view = self._store.view
        if view.run_id:
            raise CellBusyError(
                f"door {door_id} was not started: {view.door_id} is being milled; wait until it is done"
            )
        self._require(self._goals.server_is_ready())
        self._node.get_logger().info(f"door {door_id!r} is started from the operator's page")
        sent = self._goals.send_goal_async(MillDoor.Goal(door_id=door_id))
        sent.add_done_callback(lambda f: f.result().get_result_async().add_done_callback(self._ended))
        return f"door {door_id} is started"

    def cancel(self) -> str:
        """End the run in hand."""
        self._require(self._cancel.service_is_ready())
        self._node.get_logger().info("the run in hand is canceled from the operator's page")
        self._cancel.call_async(MillDoor.Impl.CancelGoalService.Request())
        return "the run in hand, if any, is canceled"

    def accept(self, version: int, who: str, why: str) -> str:
        """Put a model in use."""
        return self._order(self._accepts, AcceptModel.Request(version=version, who=who, why=why))

    def revert(self, version: int, who: str, why: str) -> str:
        """Take the model in use back."""
        return self._order(self._reverts, RevertModel.Request(version=version, who=who, why=why))

    def _order(self, client: Any, request: Any) -> str:
        missing = "the monitor of the model does not answer; check that /model_monitor is running"
        if not client.service_is_ready():
            raise NodeInactiveError(missing)
        try:
            response = result_of(client.call_async(request), MODEL_LIMIT, missing)
        except StageTimeoutError:
            raise NodeInactiveError(missing) from None
        if not response.success:
            raise StageRefusedError(response.message, response.error_code)
        self._node.get_logger().info(f"from the operator's page, by {request.who}: {response.message}")
        return str(response.message)

    def doors(self, prefix: str) -> list[str]:
        """Doors of the recipe database."""
        request = ListRecipes.Request(door_id_prefix=prefix, limit=OFFERED_DOORS)
        missing = "the recipe database does not answer; check that /recipe_database is running"
        try:
            response = result_of(self._recipes.call_async(request), DATABASE_LIMIT, missing)
        except StageTimeoutError:
            raise NodeInactiveError(missing) from None
        return [record.door_id for record in response.recipes]

    def _ended(self, future: Any) -> None:
        result = future.result().result
        # A goal that never became a run is told of nowhere else.
        if not result.run_id:
            self._store.update(lambda view: view.with_notice(result.message, result.error_code))

    def _require(self, ready: bool) -> None:
        if not (ready and self._node.active):
            raise NodeInactiveError(
                f"the action mill_door is not served; check that /{self._server} is running"
            )
