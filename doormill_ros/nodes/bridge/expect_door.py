"""The service abb/expect_door: which door is being loaded, read off the door by a bar code reader."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from concurrent.futures import TimeoutError as NotInTime
from typing import Any

from rclpy.callback_groups import CallbackGroup

from doormill_interfaces.srv import ExpectDoor, GetRecipe
from doormill_ros.abb.link_errors import DoorNameError, WriteTimeoutError
from doormill_ros.cell.errors import StageRefusedError
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.named_door import check_named_once

LIMIT = 5.0  # s


class ExpectDoorServer:
    """Passes the name of a door on to the robot program; a bar code is looked up in the recipes.

    Args:
        node: Owner.
        tell: Hands a name to the controller.
        group: Lets the recipe's answer come while the service waits for it.
    """

    def __init__(self, node: ManagedNode, tell: Callable[[str], Future[None]], group: CallbackGroup) -> None:
        self._tell = tell
        self._recipes = node.create_client(GetRecipe, "recipes/get", callback_group=group)
        node.keep(node.destroy_client, self._recipes)
        node.serve(ExpectDoor, "abb/expect_door", self._expect)

    def _expect(self, request: Any, response: Any) -> Any:
        check_named_once(request)
        door_id = request.door_id or self._look_up(request.bar_code)
        told = self._tell(door_id)
        try:
            told.result(LIMIT)
        except (NotInTime, CancelledError) as error:
            told.cancel()
            raise WriteTimeoutError(
                f"the name of door {door_id} was not passed on within {LIMIT:g} s, or another one took its place; "
                "see abb/status and read the code again"
            ) from error
        response.success = True
        response.door_id = door_id
        return response

    def _look_up(self, bar_code: str) -> str:
        heard = threading.Event()
        future = self._recipes.call_async(GetRecipe.Request(bar_code=bar_code))
        future.add_done_callback(lambda _: heard.set())
        answer = future.result() if heard.wait(LIMIT) else None
        if answer is None:
            raise StageRefusedError(
                f"nobody answered which door has bar code {bar_code!r}; check that /recipe_database is active",
                DoorNameError.code,
            )
        if not answer.success:
            raise StageRefusedError(answer.message, answer.error_code)
        return str(answer.recipe.door_id)
