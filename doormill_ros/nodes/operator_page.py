"""Node /operator_page: what the cell does, live in a browser; starts and cancels runs for who has the token."""

from __future__ import annotations

import threading
import time
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from sensor_msgs.msg import Image

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import AbbStatus, DoorLocalization, DoorRecipe, RunResult
from doormill_interfaces.srv import ListRecipes
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.errors import CellBusyError, NodeInactiveError
from doormill_ros.localization.errors import BadPicture
from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.geometry import seconds_of
from doormill_ros.nodes.convert.picture import picture_of
from doormill_ros.nodes.managed_node import ERROR, OK, ManagedNode, Parameter
from doormill_ros.operator.history import append_history, load_history
from doormill_ros.operator.page_server import PageServer, is_loopback
from doormill_ros.operator.picture import MEDIA_TYPE, encode_picture
from doormill_ros.operator.server import create_app
from doormill_ros.operator.state import EndedRun, ViewStore

BRIDGE = "abb_bridge"
SILENCE = 5.0  # s; nodes report on themselves every second
KEPT_PICTURES = 4
OFFERED_DOORS = 20
DATABASE_LIMIT = 5.0  # s
ACTION = "mill_door"
FEEDBACK = topics.Topic(
    f"{ACTION}/_action/feedback", MillDoor.Impl.FeedbackMessage, topics.EVENT, topics.EVENT
)


class OperatorPage(ManagedNode):
    """Shows the cell on a web page; the token for control is handed over here, never as a parameter."""

    PARAMETERS = (
        Parameter("host", "127.0.0.1", "address the page is served at, unencrypted; 0.0.0.0: every network"),
        Parameter("port", 8080, "TCP port of the page; 0: any free one", 0, 65535),
        Parameter(
            "history", "out/runs", "folder that keeps the ended runs, the summaries of single runs too"
        ),
    )

    def __init__(self, token: str | None = None, **kwargs: Any) -> None:
        """Show only, unless a token is given that allows control."""
        super().__init__("operator_page", **kwargs)
        self._token = token
        self.url = ""

    def setup(self) -> None:
        """Serve the page and subscribe."""
        self.store = ViewStore()
        self._history = Path(self.value("history"))
        self.store.update(lambda view: view.with_history(load_history(self._history)))
        self._bridge_heard = float("-inf")
        self._pictures: deque[Image] = deque(maxlen=KEPT_PICTURES)
        host = self.value("host")
        control = _Control(self) if self._token else None
        hosts = (host, "127.0.0.1", "localhost", "[::1]") if is_loopback(host) else ("*",)
        app = create_app(self.store, control, self._token, hosts)
        self._server = PageServer(app, host, self.value("port")).start()
        self.url = self._server.url
        self.subscribe(topics.ABB_STATUS, self._take_status)
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_LOCALIZATION, self._take_localization)
        self.subscribe(topics.DOOR_OVERLAY, self._take_overlay)
        self.subscribe(topics.IMAGE, self._pictures.append)
        self.subscribe(topics.RUN_RESULT, self._take_result)
        self.subscribe(topics.DIAGNOSTICS, self._take_diagnostics)
        self.subscribe(FEEDBACK, self._take_feedback)
        self.every(1.0, self._look_for_bridge)
        self.get_logger().info(f"operator's page at {self.url}")

    def start(self) -> None:
        """Say where the page is."""
        self.report(OK, "serving", url=self.url, control=self._token is not None)

    def teardown(self) -> None:
        """Stop serving."""
        self._server.stop()

    def _take_status(self, status: AbbStatus) -> None:
        self.store.update(lambda view: view.with_handshake(status.state, status.reason))

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        self.store.update(lambda view: view.with_run(recipe.run_id, recipe.door_id))

    def _take_feedback(self, message: Any) -> None:
        feedback = message.feedback
        self.store.update(lambda view: view.with_stage(feedback.stage, feedback.progress))

    def _take_localization(self, found: DoorLocalization) -> None:
        if found.accepted:
            self.store.update(lambda view: view.with_found_door(found.run_id))
            return
        self.store.update(lambda view: view.with_refused_picture(found.run_id, found.reason))
        for picture in tuple(self._pictures):
            # What cannot be read cannot be shown; the refusal says so.
            with suppress(BadPicture):
                if picture.header.stamp == found.header.stamp:
                    self._show(picture_of(picture), f"Refused picture of door {found.door_id}")

    def _take_overlay(self, overlay: Image) -> None:
        taken = time.strftime("%H:%M:%S", time.localtime(seconds_of(overlay.header.stamp)))
        colours = np.asarray(overlay.data, dtype=np.uint8).reshape(overlay.height, overlay.width, 3)
        self._show(colours, f"Picture of {taken} with the door's edges as they were found")

    def _show(self, picture: FloatArray, caption: str) -> None:
        data = encode_picture(picture)
        self.store.update(lambda view: view.with_picture(data, MEDIA_TYPE, caption))

    def _take_result(self, result: RunResult) -> None:
        ended = EndedRun(
            result.run_id,
            result.door_id,
            result.success,
            result.error_code,
            result.message,
            seconds_of(result.header.stamp),
        )
        known = any(run.run_id == ended.run_id for run in self.store.view.history)
        self.store.update(lambda view: view.with_ended(ended))
        if not known:
            append_history(self._history, ended)

    def _take_diagnostics(self, array: DiagnosticArray) -> None:
        for status in array.status:
            if status.name == BRIDGE:
                self._bridge_heard = time.monotonic()
                self._look_for_bridge()
            fault = status.message if status.level == ERROR else ""
            self.store.update(lambda view, name=status.name, text=fault: view.with_fault(name, text))

    def _look_for_bridge(self) -> None:
        present = time.monotonic() - self._bridge_heard < SILENCE
        self.store.update(lambda view: view.with_bridge(present))


class _Control:
    """What the page asks of the action mill_door; called from the web server's threads."""

    def __init__(self, node: OperatorPage) -> None:
        self._node = node
        group = ReentrantCallbackGroup()
        self._goals = node.keep(
            ActionClient.destroy, ActionClient(node, MillDoor, ACTION, callback_group=group)
        )
        self._recipes = node.keep(
            node.destroy_client, node.create_client(ListRecipes, "recipes/list", callback_group=group)
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
        view = self._node.store.view
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

    def doors(self, prefix: str) -> list[str]:
        """Doors of the recipe database."""
        request = ListRecipes.Request(door_id_prefix=prefix, limit=OFFERED_DOORS)
        answered = threading.Event()
        future = self._recipes.call_async(request)
        future.add_done_callback(lambda _: answered.set())
        if not answered.wait(DATABASE_LIMIT):
            raise NodeInactiveError(
                "the recipe database does not answer; check that /recipe_database is running"
            )
        return [record.door_id for record in future.result().recipes]

    def _ended(self, future: Any) -> None:
        result = future.result().result
        # A goal that never became a run is told of nowhere else.
        if not result.run_id:
            self._node.store.update(lambda view: view.with_notice(result.message))

    def _require(self, ready: bool) -> None:
        if not (ready and self._node.active):
            raise NodeInactiveError("the action mill_door is not served; check that /abb_bridge is running")
