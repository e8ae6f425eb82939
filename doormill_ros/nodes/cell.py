"""All nodes of the cell composed into one process, on simulated hardware."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.cell.layout import DoorOffset
from doormill_ros.cell.run_folder import RunFolder
from doormill_ros.cell.summary import FeatureError, RunSummary, StageDurations, localization_error
from doormill_ros.nodes import topics
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.bag_recorder import BagRecorder
from doormill_ros.nodes.camera_simulator import CameraSimulator
from doormill_ros.nodes.composition import Composition
from doormill_ros.nodes.controller_simulator import ControllerSimulator
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode

THREADS = 6
START_LIMIT = 20.0  # s
RUN_LIMIT = 900.0  # s
TRUTH_LIMIT = 180.0  # s, for what the simulation tells after a run

NODES: tuple[Callable[..., ManagedNode], ...] = (
    BagRecorder,
    RecipeDatabaseNode,
    DoorLocalizer,
    PathGenerator,
    AbbBridge,
    CameraSimulator,
    ControllerSimulator,
)


@dataclass(frozen=True)
class CellOptions:
    """What the user of the one-process cell may choose.

    Attributes:
        parameters: By node name.
        page: Serve the operator's page.
        token: Allows control from that page; None: it only shows.
    """

    parameters: dict[str, dict[str, Any]] = field(default_factory=dict)
    page: bool = False
    token: str | None = field(default=None, repr=False)

    def arguments(self, folder: RunFolder) -> list[str]:
        """ROS arguments that put everything the nodes write into the run's folder."""
        chosen: dict[str, dict[str, Any]] = {
            "bag_recorder": {"bag": folder.bag},
            "abb_bridge": {"address": folder.controller, "archive": folder.targets},
            "controller_simulator": {"home": folder.controller},
            "operator_page": {"history": folder.root},
        }
        for node, values in self.parameters.items():
            chosen.setdefault(node, {}).update(values)
        arguments = ["cell", "--ros-args"]
        for node, values in chosen.items():
            for name, value in values.items():
                text = str(value).lower() if isinstance(value, bool) else str(value)
                arguments += ["-p", f"{node}:{name}:={text}"]
        return arguments


class _Observer(Node):
    """Sends the goal and keeps the latest message of the topics the summary needs."""

    KEPT = (topics.DOOR_LOCALIZATION, topics.DOOR_PLACEMENT, topics.MILLED_DOOR)

    def __init__(self) -> None:
        super().__init__("cell")
        self.latest: dict[str, Any] = {}
        self.changed = threading.Condition()
        self.action = ActionClient(self, MillDoor, "mill_door")
        for topic in self.KEPT:
            self.create_subscription(
                topic.type, topic.name, lambda m, name=topic.name: self._keep(name, m), topic.requested
            )

    def destroy_node(self) -> None:
        """The action's client is not destroyed with its node."""
        self.action.destroy()
        super().destroy_node()

    def _keep(self, name: str, message: Any) -> None:
        with self.changed:
            self.latest[name] = message
            self.changed.notify_all()

    def of_run(self, topic: topics.Topic, run_id: str, limit: float) -> Any:
        """The topic's message of a run, None when it does not come."""
        with self.changed:
            self.changed.wait_for(lambda: self._of(topic, run_id) is not None, limit)
            return self._of(topic, run_id)

    def _of(self, topic: topics.Topic, run_id: str) -> Any:
        message = self.latest.get(topic.name)
        return message if message is not None and message.run_id == run_id else None


class Cell:
    """The running cell; a context manager.

    Args:
        folder: Where the run's files go; prepared by the caller.
        options: Parameters of the nodes.
    """

    def __init__(self, folder: RunFolder, options: CellOptions | None = None) -> None:
        self._folder = folder
        options = options or CellOptions()
        nodes = list(NODES)
        if options.page:
            nodes.append(partial(OperatorPage, options.token))
        self._composition = Composition(options.arguments(folder), nodes, _Observer, THREADS)

    def __enter__(self) -> Cell:
        self._composition.__enter__()
        self._observer = self._composition.driver
        try:
            if not self._observer.action.wait_for_server(START_LIMIT):
                raise StageTimeoutError(f"the action mill_door was not there after {START_LIMIT:g} s")
        except BaseException:
            self._composition.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._composition.__exit__(kind, error, trace)

    def mill(self, door_id: str, progress: Callable[[str, float], None] | None = None) -> RunSummary:
        """Mill one door and sum up; a refused door gives a summary too.

        Args:
            door_id: Which door.
            progress: Called with the stage's name and 0..1.

        Raises:
            StageTimeoutError: The action did not end.
        """

        def feedback(message: Any) -> None:
            if progress is not None:
                progress(message.feedback.stage, message.feedback.progress)

        sent = self._observer.action.send_goal_async(MillDoor.Goal(door_id=door_id), feedback)
        goal = _await(sent, START_LIMIT, "the goal was not taken")
        result = _await(goal.get_result_async(), RUN_LIMIT, "the run did not end").result
        return self._summary(door_id, result)

    def stay(self) -> None:
        """Keep the cell up until the process is interrupted."""
        with suppress(KeyboardInterrupt):
            while rclpy.ok():
                time.sleep(0.1)

    def _summary(self, door_id: str, result: MillDoor.Result) -> RunSummary:
        limit = TRUTH_LIMIT if result.success else 0.0
        found = self._observer.of_run(topics.DOOR_LOCALIZATION, result.run_id, 0.0)
        true = self._observer.of_run(topics.DOOR_PLACEMENT, result.run_id, 0.0)
        milled = self._observer.of_run(topics.MILLED_DOOR, result.run_id, limit)
        known = found is not None and found.accepted and true is not None
        return RunSummary(
            door_id=door_id,
            success=result.success,
            message=result.message,
            error_code=result.error_code,
            run_id=result.run_id,
            recipe_version=result.recipe_version,
            target_file=result.target_file,
            sha256=result.sha256,
            bag=str(self._folder.bag),
            report=str(self._folder.report),
            largest_correction=result.largest_correction,
            times=StageDurations(
                **{name: getattr(result.times, name) for name in StageDurations.__dataclass_fields__}
            ),
            localization_error=localization_error(_offset(found), _offset(true)) if known else DoorOffset(),
            feature_error=FeatureError()
            if milled is None
            else FeatureError(milled.uncorrected_max, milled.corrected_max, milled.tolerance),
        )


def _offset(message: Any) -> DoorOffset:
    return DoorOffset(message.offset_y, message.offset_z, message.offset_rotation)


def _await(future: Any, limit: float, otherwise: str) -> Any:
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    if not done.wait(limit):
        raise StageTimeoutError(f"{otherwise} (waited {limit:g} s)", limit=limit)
    return future.result()


def run_once(
    door_id: str,
    folder: Path,
    options: CellOptions | None = None,
    progress: Callable[[str, float], None] | None = None,
    milled: Callable[[RunSummary], None] | None = None,
) -> RunSummary:
    """Bring the cell up, mill one door, take it down, write summary.json.

    With the operator's page, `milled` is called after that door and the cell stays up until interrupted.
    """
    run_folder = RunFolder(folder.resolve())
    run_folder.prepare()
    with Cell(run_folder, options) as cell:
        summary = cell.mill(door_id, progress)
        if options is not None and options.page:
            summary.write(run_folder.summary)
            if milled is not None:
                milled(summary)
            cell.stay()
    summary.write(run_folder.summary)
    return summary
