"""Part of a node that has runs in hand: the recipe database, asked under the run's id."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup

from doormill_interfaces.srv import GetRecipe
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.pipeline.partners import RecipeAnswer


class RecipeClient:
    """The service recipes/get as a run asks it.

    Args:
        node: Owner.
        group: Lets its answers come while a goal is executed.
    """

    def __init__(self, node: ManagedNode, group: CallbackGroup) -> None:
        self._node = node
        self._client = node.create_client(GetRecipe, "recipes/get", callback_group=group)

    @property
    def ready(self) -> bool:
        """The service is there."""
        return bool(self._client.service_is_ready())

    def ask(self, door_id: str, run_id: str, hear: Callable[[RecipeAnswer], None]) -> None:
        """Send a request."""

        def answered(future: Any) -> None:
            response = future.result()
            if response is not None:
                version = int(response.recipe.version)
                hear(RecipeAnswer(response.success, response.error_code, response.message, version))

        request = GetRecipe.Request(door_id=door_id, run_id=run_id)
        self._client.call_async(request).add_done_callback(answered)

    def close(self) -> None:
        """Give the client back."""
        self._node.destroy_client(self._client)
