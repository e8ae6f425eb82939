"""Node /model_monitor: tells what inspected doors and the bags of runs say; puts models in use on order."""

from __future__ import annotations

import sys
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorInspection, RunResult
from doormill_interfaces.srv import AcceptModel, HandInInspection, RevertModel
from doormill_ros.catalogue.inspection_notes import InspectionNotes
from doormill_ros.cell.graph.node_names import MODEL_MONITOR
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.diagnosis.runs.limits import MOST
from doormill_ros.errors import DoormillError
from doormill_ros.measurements.inspections.inspection import CAMERA
from doormill_ros.messages.from_message import positions_of
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.models.errors import MillingStoppedError
from doormill_ros.models.store import store_folder
from doormill_ros.monitor.kept_doors import DoorPoints
from doormill_ros.monitor.questioner import Questioner
from doormill_ros.monitor.runs_watch import RunsState, RunsWatch
from doormill_ros.monitor.watch import ModelWatch
from doormill_ros.monitor.watch_state import WatchSettings, WatchState
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import ERROR, OK, WARN
from doormill_ros.nodes.convert.inspection import inspection_message
from doormill_ros.nodes.convert.runs_verdict import verdict_of_runs
from doormill_ros.nodes.convert.verdict import verdict_of_model
from doormill_ros.nodes.process.run import run_nodes

PERIOD = 1.0  # s


class ModelMonitor(ManagedNode):
    """Carries inspections and ends of runs to who watches them, and what these know to whoever listens."""

    PARAMETERS = (
        NodeParameter("inspections", "out/inspections", "folder that keeps inspections and the last verdict"),
        NodeParameter("bags", "out/bags", "folder below which runs are recorded"),
        NodeParameter(
            "models",
            "",
            "folder of the store of models, as that of /path_generator; empty: models in the site's folder",
        ),
        NodeParameter("robot_model", "", "model of version 0, as robot_model of /path_generator"),
        NodeParameter("doors", 40, "last inspected doors that are questioned", 1, 1000, live=True),
        NodeParameter(
            "runs",
            60,
            "last runs that are asked by bags alone, 6 or more; 0: never",
            0,
            MOST,
            live=True,
        ),
        NodeParameter("since", "", "run before which doors and bags are left aside; empty: none", live=True),
        NodeParameter(
            "limit.expected",
            TOLERANCE,
            "expected error of the next door beyond which none is milled [m]; 0: none",
            0.0,
            1.0,
            live=True,
        ),
        NodeParameter(
            "catalogue",
            "",
            "database that inspections are noted in, as that of /bag_recorder, so that their bags stay; none: no",
        ),
        NodeParameter("limit.diagnosis", 1800.0, "longest diagnosis [s]", 1.0, 86400.0, live=True),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(MODEL_MONITOR, **kwargs)

    def setup(self) -> None:
        """Open what is kept, subscribe, offer the services."""
        folder, catalogue = Path(self.value("inspections")), self.value("catalogue")
        self._notes = None if catalogue == "none" else InspectionNotes(catalogue, folder, self._tell)
        bags = Path(self.value("bags"))
        # One for both: the diagnosis has one process, behind the running cell.
        self._questioner = Questioner(folder, lambda: self._settings().patience)
        self._runs = RunsWatch(bags, self._settings, self._questioner, self._tell)
        self._watch = ModelWatch(
            folder,
            bags,
            store_folder(self.value("models")),
            self._settings,
            self._questioner,
            self._tell,
            lambda run_id: None if self._notes is None else self._notes.note(run_id),
        )
        self._settled = self._settings()
        self._verdict = self.publisher(topics.MODEL_VERDICT)
        self._runs_verdict = self.publisher(topics.RUNS_VERDICT)
        self._inspected = self.publisher(topics.MODEL_INSPECTED)
        self._watch.start()
        self._runs.start()
        self._questioner.start()
        if self._notes is not None:
            self._notes.start()
        self.subscribe(topics.DOOR_INSPECTION, self._take)
        self.subscribe(topics.RUN_RESULT, self._take_end)
        self.serve(HandInInspection, "model/inspect", self._hand_in)
        self.serve(AcceptModel, "model/accept", self._accept)
        self.serve(RevertModel, "model/revert", self._revert)
        self.every(PERIOD, self._look)

    def start(self) -> None:
        """Tell what is known."""
        self._tell()

    def teardown(self) -> None:
        """Give up the question in hand; it is asked again after the next start."""
        self._questioner.stop()
        self._runs.stop()
        self._watch.stop()
        if self._notes is not None:
            self._notes.stop()

    def state(self) -> WatchState:
        """What is known now; of a configured node.

        Raises:
            ModelStoreError: The store of models cannot be read.
        """
        return self._watch.state()

    def runs_at_end(self, limit: float) -> RunsState:
        """What the bags of all runs say once no more come, or after so long [s]; of a configured node."""
        return self._runs.at_end(limit)

    def _settings(self) -> WatchSettings:
        return WatchSettings(
            self.value("doors"),
            self.value("since"),
            self.value("limit.expected"),
            self.value("limit.diagnosis"),
            self.value("robot_model"),
            self.value("runs"),
        )

    def _look(self) -> None:
        settings = self._settings()
        if settings != self._settled:
            self._settled = settings
            self._watch.settle()
            self._runs.settle()

    def _take_end(self, result: RunResult) -> None:
        self._runs.ended(result.run_id)

    def _take(self, message: DoorInspection) -> None:
        self._watch.take(
            DoorPoints(
                message.run_id,
                datetime.fromtimestamp(seconds_of(message.header.stamp), UTC),
                message.noise,
                message.datum or CAMERA,
                list(message.feature),
                ["wall" if wall else "floor" for wall in message.wall],
                positions_of(message.point),
                positions_of(message.normal),
                message.deviation,
            )
        )

    def _hand_in(self, request: Any, response: Any) -> Any:
        taken = self._watch.hand_in(Path(request.path), self._pass_on)
        response.success = True
        response.run_ids = [door.run_id for door in taken]
        response.message = f"{len(taken)} inspections taken from {request.path}"
        return response

    def _pass_on(self, points: DoorPoints) -> None:
        told = points.run_id, points.measured_at, points.noise, points.datum
        self._inspected.publish(inspection_message(points, *told))

    def _accept(self, request: Any, response: Any) -> Any:
        return self._order(request, response, self._watch.accept)

    def _revert(self, request: Any, response: Any) -> Any:
        return self._order(request, response, self._watch.revert)

    def _order(self, request: Any, response: Any, give: Callable[[int, str, str], int]) -> Any:
        response.version = give(request.version, request.who, request.why)
        response.success = True
        response.message = f"version {response.version} of the model is in use from the next run on"
        self.get_logger().info(f"{response.message}: {request.who}, {request.why}")
        return response

    def _tell(self) -> None:
        """Publish the state; called from the watch's threads, too."""
        if not (self.configured and self.context.ok()):
            return
        try:
            state = self._watch.state()
        except DoormillError as error:
            self.report(ERROR, error.message, error_code=error.code)
            return
        runs, header = self._runs.state(), Header(stamp=self.get_clock().now().to_msg())
        self._verdict.publish(verdict_of_model(state, header))
        self._runs_verdict.publish(verdict_of_runs(runs, header))
        figures = {"version": state.version, "proposed": state.proposed, "expected_error": state.expected}
        warnings = self._warnings(state, runs)
        if warnings:
            said, code = "; ".join(text for text, _ in warnings), warnings[0][1]
            self.report(WARN, said, **({"error_code": code} if code else {}), **figures)
        else:
            said = "no door was inspected yet" if state.finding is None else state.finding.sentence
            self.report(OK, said, waiting=state.waiting, **figures)

    def _warnings(self, state: WatchState, runs: RunsState) -> list[tuple[str, int]]:
        """What a person has to see, with the code of its error or 0, the gravest first."""
        doors = (
            (state.stopped, MillingStoppedError.code) if state.stopped else (state.message, state.error_code)
        )
        changed = runs.finding.sentence if runs.finding is not None and runs.finding.changes else ""
        unnoted = self._notes.failure if self._notes is not None else ""
        return [one for one in (doors, (changed, 0), (runs.message, runs.error_code), (unnoted, 0)) if one[0]]


def main() -> int:
    """Run the node."""
    return run_nodes(ModelMonitor)


if __name__ == "__main__":
    sys.exit(main())
