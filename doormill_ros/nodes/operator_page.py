"""Node /operator_page: what the cell does, live in a browser; starts and cancels runs for who has a token."""

from __future__ import annotations

import sys
import time
from collections import deque
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import Image

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import (
    AbbStatus,
    DoorInspection,
    DoorLocalization,
    DoorRecipe,
    MilledDoor,
    ModelVerdict,
    RunResult,
    RunsVerdict,
    TargetArray,
)
from doormill_ros.arrays import ByteArray
from doormill_ros.cell.graph.node_names import ABB_BRIDGE, OPERATOR_PAGE
from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.localization.errors import BadPicture
from doormill_ros.messages.from_message import gauged_of, inspection_of, recipe_of
from doormill_ros.messages.picture import colours_of, picture_of
from doormill_ros.messages.stamps import nanoseconds_of, seconds_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import ERROR, OK
from doormill_ros.nodes.base.robots import ROBOTS
from doormill_ros.nodes.clients.operator_control import ACTION, ActionControl
from doormill_ros.nodes.convert.planned_times import planned_times_of
from doormill_ros.nodes.convert.runs_verdict import view_of_runs
from doormill_ros.nodes.convert.verdict import view_of_model
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.operator.access.token import Keys
from doormill_ros.operator.access.token_file import load_keys
from doormill_ros.operator.history.run_book import RunBook
from doormill_ros.operator.orders.audit import AuditLog
from doormill_ros.operator.serving.page_names import is_address, page_names
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.captioned_picture import CAPTIONS
from doormill_ros.operator.views.door_view import door_view, worst_by_feature
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.shown_door import ShownDoors
from doormill_ros.operator.views.state import CellView
from doormill_ros.operator.views.view_store import ViewStore
from doormill_ros.pages.picture import MEDIA_TYPE, encode_picture
from doormill_ros.recipes.errors import RecipeError
from doormill_ros.resources import AUDIT, site_folder
from doormill_ros.toolpath.settings import load_settings

CONTROLLER = "/controller"  # what the bridge tells of it
SILENCE = 5.0  # s; nodes report on themselves every second
KEPT_PICTURES = 4
FEEDBACK = topics.Topic(
    f"{ACTION}/_action/feedback", MillDoor.Impl.FeedbackMessage, topics.EVENT, topics.EVENT
)


class OperatorPage(ManagedNode):
    """Shows the cell on a web page; tokens for control are handed over here or stand in a file, never in parameters."""

    PARAMETERS = (
        NodeParameter(
            "host", "127.0.0.1", "address the page is served at, unencrypted; 0.0.0.0: every network"
        ),
        NodeParameter(
            "names",
            "",
            "host names under which the page is reached, with commas, beside this machine's own; addresses always do",
        ),
        NodeParameter("port", 8080, "TCP port of the page; 0: any free one", 0, 65535),
        NodeParameter(
            "tokens",
            "",
            "file with tokens of the roles operate and engineer, made where there is none; empty: only shown",
        ),
        NodeParameter(
            "history", "out/runs", "folder that keeps the ended runs, the summaries of single runs too"
        ),
        NodeParameter(
            "audit",
            "",
            "folder of the audit log of orders and refused tries; empty: audit in the site's folder",
        ),
        NodeParameter("robots", 1, "2: two robots share the doors, their nodes in namespaces", 1, 2),
    )

    def __init__(self, token: str | Keys | None = None, **kwargs: Any) -> None:
        """Show only, unless a token is given that allows control, or one for each role, or a file of them is named."""
        super().__init__(OPERATOR_PAGE, **kwargs)
        self._given = token
        self.url = ""

    def setup(self) -> None:
        """Serve the page and subscribe."""
        self.store = ViewStore()
        history = Path(self.value("history"))
        self._runs = RunBook(self.store, history)
        two = self.value("robots") > 1
        # By place below the cell's namespace: that of the only robot is the cell's own.
        self._places = {in_robot(name): number for number, name in enumerate(ROBOTS, 1)} if two else {"": 0}
        self._settings = load_settings() if two else None
        own = self.get_namespace()
        self._namespaces = {f"{own}/{place}".strip("/"): place for place in ("", *self._places)}
        self._bridges_heard = dict.fromkeys(self._places, float("-inf"))
        self._look_for_bridges()
        self._shown: ShownDoors[Image] = ShownDoors()
        self._pictures: deque[Image] = deque(maxlen=KEPT_PICTURES)
        host, tokens = self.value("host"), self.value("tokens")
        token = self._given or (load_keys(Path(tokens)) if tokens else None)
        control = ActionControl(self, self.store) if token else None
        names = page_names(self.value("names"))
        if not is_address(host):
            names = (*names, host.lower())
        audit = AuditLog(Path(self.value("audit") or site_folder() / AUDIT))
        app = create_app(self.store, control, token, names, audit, history=history)
        self._controls = control is not None
        self._server = PageServer(app, host, self.value("port")).start()
        self.url = self._server.url
        for place, robot in self._places.items():
            self.subscribe(topics.at(topics.ABB_STATUS, place), partial(self._take_status, robot=robot))
            self.subscribe(topics.at(topics.PATH_TARGETS, place), partial(self._take_targets, robot=robot))
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_LOCALIZATION, self._take_localization)
        self.subscribe(topics.DOOR_OVERLAY, self._take_overlay)
        self.subscribe(topics.IMAGE, self._pictures.append)
        self.subscribe(topics.RUN_RESULT, self._take_result)
        self.subscribe(topics.MILLED_DOOR, self._take_milled)
        self.subscribe(topics.DOOR_INSPECTION, self._take_inspection)
        handed_in = topics.MODEL_INSPECTED
        self.subscribe(replace(handed_in, requested=handed_in.offered), self._take_inspection)
        self.subscribe(topics.DIAGNOSTICS, self._take_diagnostics)
        self.subscribe(topics.MODEL_VERDICT, self._take_verdict)
        self.subscribe(topics.RUNS_VERDICT, self._take_runs)
        self.subscribe(FEEDBACK, self._take_feedback)
        self.every(1.0, self._look_for_bridges)
        self.get_logger().info(f"operator's page at {self.url}")

    def start(self) -> None:
        """Say where the page is."""
        self.report(OK, "serving", url=self.url, control=self._controls)

    def teardown(self) -> None:
        """Stop serving."""
        self._server.stop()

    def _take_status(self, status: AbbStatus, robot: int = 0) -> None:
        since = seconds_of(status.since)
        if robot:
            told = status.state, status.reason, status.run_id, status.request, since, status.error_code
            self.store.update(lambda view: view.with_robot_handshake(robot, *told))
            return
        shown = status.state, status.reason, status.run_id, status.door_id, status.request, since
        self.store.update(lambda view: view.with_handshake(*shown, error_code=status.error_code))

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        since = seconds_of(recipe.header.stamp)
        self.store.update(lambda view: view.with_run(recipe.run_id, recipe.door_id, since))
        # A recipe that cannot be read is refused by who mills it; the page goes on without a drawing.
        with suppress(RecipeError):
            drawing = door_view(recipe_of(recipe), recipe.run_id, self._settings)
            self.store.update(lambda view: view.with_drawing(drawing))

    def _take_targets(self, targets: TargetArray, robot: int = 0) -> None:
        if targets.accepted and self.store.view.draws(targets.run_id):
            times = planned_times_of(targets)
            self.store.update(lambda view: view.with_plan(targets.run_id, times, robot or None))

    def _take_milled(self, door: MilledDoor) -> None:
        worst = {feature.feature: feature.corrected_max for feature in door.features}
        self._runs.measured_in_cell(door.run_id, inspection_of(door), worst)

    def _take_inspection(self, measured: DoorInspection) -> None:
        worst = worst_by_feature(zip(measured.feature, measured.deviation, strict=False))
        at = max(seconds_of(measured.header.stamp), 0.0)
        self._runs.gauged(measured.run_id, gauged_of(measured), at, worst)

    def _take_feedback(self, message: Any) -> None:
        feedback = message.feedback
        self.store.update(lambda view: view.with_stage(feedback.stage, feedback.progress))

    def _take_localization(self, found: DoorLocalization) -> None:
        overlay = self._shown.of_door(nanoseconds_of(found.header.stamp), found.door_id)
        if overlay is not None:
            self._show_overlay(overlay, found.door_id)
        if found.accepted:
            self.store.update(lambda view: view.with_found_door(found.run_id))
            return
        refused = found.run_id, found.reason, found.error_code
        self.store.update(lambda view: view.with_refused_picture(*refused))
        for picture in tuple(self._pictures):
            # What cannot be read cannot be shown; the refusal says so.
            with suppress(BadPicture):
                if picture.header.stamp == found.header.stamp:
                    self._show(picture_of(picture), "refused", door=found.door_id)

    def _take_overlay(self, overlay: Image) -> None:
        door = self._shown.of_picture(nanoseconds_of(overlay.header.stamp), overlay)
        if door is not None:
            self._show_overlay(overlay, door)

    def _show_overlay(self, overlay: Image, door: str) -> None:
        try:
            colours = colours_of(overlay)
        except BadPicture as error:  # nothing is wrong with the page, and what comes with it is shown
            self.get_logger().warning(
                f"what came on {topics.DOOR_OVERLAY.name} is not shown: {error.message}"
            )
            return
        taken = time.strftime("%H:%M:%S", time.localtime(seconds_of(overlay.header.stamp)))
        self._show(colours, "found", door=door, time=taken)

    def _show(self, picture: ByteArray, key: str, **values: str) -> None:
        data, caption = encode_picture(picture), CAPTIONS[key].format(**values)
        self.store.update(lambda view: view.with_picture(data, MEDIA_TYPE, caption, key, values))

    def _take_result(self, result: RunResult) -> None:
        self._runs.ended(
            EndedRun(
                result.run_id,
                result.door_id,
                result.success,
                result.error_code,
                result.message,
                seconds_of(result.header.stamp),
                result.measured,
            )
        )

    def _take_verdict(self, said: ModelVerdict) -> None:
        self.store.update(lambda view: view.with_model(view_of_model(said)))

    def _take_runs(self, said: RunsVerdict) -> None:
        self.store.update(lambda view: view.with_runs(view_of_runs(said)))

    def _take_diagnostics(self, array: DiagnosticArray) -> None:
        for status in array.status:
            namespace, _, node = status.name.removesuffix(CONTROLLER).rpartition("/")
            place = self._namespaces.get(namespace)
            if place is None:
                continue  # of another cell
            if place in self._places and node == ABB_BRIDGE and not status.name.endswith(CONTROLLER):
                self._bridges_heard[place] = time.monotonic()
                self._look_for_bridges()
            fault = status.message if status.level == ERROR else ""
            self._take_fault(status.name, fault, code_of(status))

    def _take_fault(self, node: str, message: str, error_code: int) -> None:
        self.store.update(lambda view: view.with_fault(node, message, error_code))

    def _look_for_bridges(self) -> None:
        now = time.monotonic()
        for place, number in self._places.items():
            present = now - self._bridges_heard[place] < SILENCE
            self.store.update(partial(_with_bridge, number=number, present=present))


def _with_bridge(view: CellView, number: int, present: bool) -> CellView:
    """Whether the bridge of a robot was heard of lately; 0: there is one robot."""
    return (
        view.with_robot(number, lambda robot: robot.heard(present)) if number else view.with_bridge(present)
    )


def code_of(status: DiagnosticStatus) -> int:
    """The error code that a node gives beside what it says of itself; 0 where it gives none."""
    told = next((pair.value for pair in status.values if pair.key == "error_code"), "")
    return int(told) if told.isdecimal() and len(told) < 6 else 0


def main() -> int:
    """Run the node."""
    return run_nodes(OperatorPage)


if __name__ == "__main__":
    sys.exit(main())
