"""The node that asks the one-process cell for a door and hears what the summary of the run needs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any

from rclpy.node import Node

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.cell.output.inspection import outcome
from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.cell.output.summary import (
    CycleTime,
    FeatureError,
    RunSummary,
    StageDurations,
    Touched,
    TouchedBody,
    localization_error,
)
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.cell.run.waiting import wait
from doormill_ros.messages.from_message import recipe_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.futures import result_of
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.pipeline.cycle import cycle_time

START_LIMIT = 60.0  # s, on a busy machine
RUN_LIMIT = 900.0  # s
TRUTH_LIMIT = 180.0  # s, for what the simulation tells after a run
NOT_INSPECTED = (
    f"the simulated controller did not tell within {TRUTH_LIMIT:g} s what was milled; its log above says why"
)


class CellDriver(Node):  # type: ignore[misc]  # rclpy has no types
    """Sends goals and keeps the latest message of each topic that a summary needs."""

    KEPT = (
        topics.DOOR_RECIPE,
        topics.DOOR_LOCALIZATION,
        topics.DOOR_PLACEMENT,
        topics.PATH_TARGETS,
        topics.MILLED_DOOR,
        topics.RUN_VERDICT,
    )

    def __init__(self) -> None:
        super().__init__("cell")
        self._latest: dict[str, Any] = {}
        self._changed = threading.Condition()
        self._action = GoalClient(self, MillDoor, "mill_door")
        for topic in self.KEPT:
            self.create_subscription(topic.type, topic.name, partial(self._keep, topic.name), topic.requested)

    def destroy_node(self) -> None:
        """The action's client is not destroyed with its node."""
        self._action.destroy()
        super().destroy_node()

    def wait_for_action(self) -> None:
        """Until goals are taken.

        Raises:
            StageTimeoutError: The action is not served.
        """
        if not self._action.wait_for_server(START_LIMIT):
            raise StageTimeoutError(
                f"the action mill_door was not there after {START_LIMIT:g} s; /diagnostics says what its node waits for"
            )

    def mill(self, door_id: str, folder: RunFolder, progress: Callable[[str, float], None]) -> RunSummary:
        """Mill one door and sum up; see `Cell.mill`."""

        def feedback(message: Any) -> None:
            progress(message.feedback.stage, message.feedback.progress)

        sent = self._action.send_goal_async(MillDoor.Goal(door_id=door_id), feedback)
        goal = result_of(sent, START_LIMIT, "the goal was not taken")
        result = result_of(goal.get_result_async(), RUN_LIMIT, "the run did not end").result
        return self._summary(door_id, folder, result)

    def _summary(self, door_id: str, folder: RunFolder, result: MillDoor.Result) -> RunSummary:
        found = self._of_run(topics.DOOR_LOCALIZATION, result.run_id)
        true = self._of_run(topics.DOOR_PLACEMENT, result.run_id)
        milled = wait(
            self._changed,
            lambda: self._of_run(topics.MILLED_DOOR, result.run_id),
            TRUTH_LIMIT if result.target_file else 0.0,
        )
        # Published before the inspection, so it is there when that is.
        verdict = self._of_run(topics.RUN_VERDICT, result.run_id)
        touched = Touched() if verdict is None else _touched(verdict)
        targets = self._of_run(topics.PATH_TARGETS, result.run_id)
        recipe = self._of_run(topics.DOOR_RECIPE, result.run_id)
        planned = recipe is not None and targets is not None and targets.accepted
        failed = result.success and verdict is not None and not verdict.success
        unknown = result.success and not result.measured
        known = found is not None and found.accepted and true is not None
        return RunSummary(
            door_id=door_id,
            success=result.success and not failed and not unknown,
            message=verdict.message if failed else NOT_INSPECTED if unknown else result.message,
            error_code=verdict.error_code
            if failed
            else StageTimeoutError.code
            if unknown
            else result.error_code,
            run_id=result.run_id,
            recipe_version=result.recipe_version,
            target_file=result.target_file,
            sha256=result.sha256,
            bag=str(folder.bag),
            report=str(folder.report),
            largest_correction=result.largest_correction,
            expected_error=0.0 if targets is None else targets.expected_error,
            robot_model=result.robot_model,
            model_version=result.model_version,
            times=StageDurations(**{f.name: getattr(result.times, f.name) for f in fields(StageDurations)}),
            localization_error=localization_error(_offset(found), _offset(true)) if known else DoorOffset(),
            feature_error=FeatureError()
            if milled is None
            else FeatureError(
                milled.uncorrected_max, milled.corrected_max, milled.tolerance, result.worst_feature
            ),
            touched=touched,
            cycle=cycle_time(recipe_of(recipe), targets.cycle_time) if planned else CycleTime(),
            measured=result.measured,
            outcome=outcome(result.success, result.error_code, result.measured),
        )

    def _keep(self, name: str, message: Any) -> None:
        with self._changed:
            self._latest[name] = message
            self._changed.notify_all()

    def _of_run(self, topic: topics.Topic, run_id: str) -> Any:
        """The topic's message of a run, None while there is none."""
        message = self._latest.get(topic.name)
        return message if message is not None and message.run_id == run_id else None


def _offset(message: Any) -> DoorOffset:
    return DoorOffset(message.offset_y, message.offset_z, message.offset_rotation)


def _touched(verdict: Any) -> Touched:
    bodies = [
        TouchedBody(
            touch.body,
            touch.obstacle,
            touch.motion,
            touch.feature,
            touch.time,
            touch.depth,
            touch.volume,
            touch.samples,
            (touch.place.x, touch.place.y, touch.place.z),
        )
        for touch in verdict.touches
    ]
    return Touched(True, verdict.judged, verdict.touched, verdict.volume, verdict.message, tuple(bodies))
