"""The action mill_door: takes one door through all stages and says how it ended."""

from __future__ import annotations

import hashlib
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import CallbackGroup

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import RunResult, StageTimes, TargetArray
from doormill_interfaces.srv import GetRecipe
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.cell.errors import CellBusyError, NodeInactiveError, StageRefusedError
from doormill_ros.cell.run import Run, StageLimits, new_run_id
from doormill_ros.errors import DoormillError
from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.geometry import seconds_of

if TYPE_CHECKING:
    from doormill_ros.nodes.abb_bridge import AbbBridge

ASK_AGAIN = 1.0  # s
REMEMBERED = 16  # runs that ended
#: States that a run which was handed over can only reach once the controller has ended it.
ENDED = (HandshakeState.DONE, HandshakeState.FAILED, HandshakeState.REQUESTED)


class MillDoorServer:
    """Serves one goal at a time; a second one is answered, not queued."""

    def __init__(self, bridge: AbbBridge, group: CallbackGroup) -> None:
        """Offer the action for as long as the node lives, so that a refused goal always gets an answer."""
        self._bridge = bridge
        self._lock = threading.Lock()
        self._run: Run | None = None
        self._ended: deque[str] = deque(maxlen=REMEMBERED)
        self._get_recipe: Any = None
        self._group = group
        self._result = bridge.create_publisher(
            topics.RUN_RESULT.type, topics.RUN_RESULT.name, topics.RUN_RESULT.offered
        )
        self._server = ActionServer(
            bridge,
            MillDoor,
            "mill_door",
            self._execute,
            callback_group=group,
            goal_callback=lambda _: GoalResponse.ACCEPT,
            cancel_callback=self._cancel,
        )

    def open(self) -> None:
        """Connect to the recipe database."""
        self._get_recipe = self._bridge.create_client(GetRecipe, "recipes/get", callback_group=self._group)

    def close(self) -> None:
        """Disconnect."""
        self.cancel()
        self._bridge.destroy_client(self._get_recipe)
        self._get_recipe = None

    def destroy(self) -> None:
        """Withdraw the action."""
        self._server.destroy()

    def deliver(self, stage: str, message: Any) -> bool:
        """Pass a stage's answer to the run in hand; False when it belongs to no run of this server."""
        run = self._run
        if run is None or message.run_id != run.run_id:
            # A second picture of a run may be answered when its door is milled already.
            return message.run_id in self._ended
        run.deliver(stage, message, seconds_of(message.header.stamp))
        return True

    def notify(self) -> None:
        """The handshake changed."""
        run = self._run
        if run is not None:
            run.notify()

    def cancel(self) -> None:
        """End the run in hand, if any."""
        run = self._run
        if run is not None:
            run.cancel()

    def _cancel(self, goal: Any) -> CancelResponse:
        self.cancel()
        return CancelResponse.ACCEPT

    def _execute(self, goal: Any) -> MillDoor.Result:
        door_id = goal.request.door_id
        if not self._lock.acquire(blocking=False):
            busy = self._run.door_id if self._run else "another door"
            error = CellBusyError(
                f"door {door_id} was refused: {busy} is being milled; wait until it is done"
            )
            goal.abort()
            return MillDoor.Result(error_code=error.code, message=error.message)
        run = self._run = Run(new_run_id(), door_id)
        result = MillDoor.Result(run_id=run.run_id)
        try:
            self._mill(run, goal, result)
        except DoormillError as error:
            result.error_code = error.stage_code if isinstance(error, StageRefusedError) else error.code
            result.message = f"door {door_id}: {error.message}"
            result.target_file = result.sha256 = ""
        except Exception as error:
            self._bridge.get_logger().error(f"run {run.run_id} ended by {type(error).__name__}: {error}")
            result.error_code = DoormillError.code
            result.message = f"door {door_id}: {type(error).__name__}: {error}; see the bridge's log"
            result.target_file = result.sha256 = ""
        finally:
            self._ended.append(run.run_id)
            self._run = None
            self._lock.release()
        self._finish(run, goal, result)
        return result

    def _finish(self, run: Run, goal: Any, result: MillDoor.Result) -> None:
        if not result.success and self._bridge.configured:
            self._bridge.handshake.abort(result.message)
        message = RunResult(
            run_id=run.run_id,
            door_id=run.door_id,
            success=result.success,
            error_code=result.error_code,
            message=result.message,
            target_file=result.target_file,
            sha256=result.sha256,
            largest_correction=result.largest_correction,
            times=result.times,
        )
        message.header.stamp = self._bridge.get_clock().now().to_msg()
        if self._bridge.context.ok():
            self._result.publish(message)
        log = self._bridge.get_logger()
        # rclpy ties a severity to the line that logs.
        if result.success:
            log.info(result.message)
        else:
            log.warning(result.message)
        if result.success:
            goal.succeed()
        elif goal.is_cancel_requested:
            goal.canceled()
        else:
            goal.abort()

    def _limits(self) -> StageLimits:
        names = StageLimits.__dataclass_fields__
        return StageLimits(**{name: self._bridge.value(f"limit.{name}") for name in names})

    def _mill(self, run: Run, goal: Any, result: MillDoor.Result) -> None:
        """From recipe to the end of milling; fills `result` as far as it gets."""
        bridge, limits, times = self._bridge, self._limits(), StageTimes()
        result.times = times
        if not bridge.active:
            raise NodeInactiveError(
                "the ABB bridge is not active; activate it (ros2 lifecycle set /abb_bridge activate)"
            )
        handshake = bridge.handshake

        def stage(name: str, progress: float) -> None:
            goal.publish_feedback(MillDoor.Feedback(stage=name, progress=progress))

        stage("recipe", 0.0)
        result.recipe_version = self._fetch_recipe(run, limits).version
        targets, request_number = self._measure(run, limits, stage, times)
        result.largest_correction = targets.largest_correction
        data = bridge.submit(targets, request_number)
        stage("targets", 0.4)
        try:
            announced = run.wait_until(
                lambda: self._announced(run),
                limits.ready,
                "the target file was not written and verified; see abb/status",
            )
        except DoormillError:
            with suppress(OSError):  # the reason counts more than the copy
                bridge.file_away(run.run_id, data)
            raise
        path = bridge.file_away(run.run_id, data)  # the controller does not wait for the copy
        times.targets_to_ready = announced["ready"] - announced["writing"]
        times.request_to_ready = announced["ready"] - announced["requested"]
        stage("ready", 0.6)
        outcome = run.wait_until(
            lambda: handshake.outcome(run.run_id),
            limits.read + limits.ready,  # the handshake itself gives up after limits.read
            "the controller does not read the target file",
        )
        self._refuse_unless(outcome.handed_over, outcome.reason, outcome.error_code)
        stage("milling", 0.7)
        run.wait_until(
            lambda: handshake.snapshot.state in ENDED,
            limits.milling,
            "the controller did not report the end of milling; look at its pendant",
        )
        end = handshake.snapshot
        if end.state is not HandshakeState.DONE:
            raise MillingFaultError(end.reason)
        stage("milling", 1.0)
        result.success = True
        result.target_file = str(path)
        result.sha256 = hashlib.sha256(data).hexdigest()
        result.message = (
            f"door {run.door_id} milled: {len(targets.targets)} targets, largest correction "
            f"{targets.largest_correction * 1e3:.3f} mm, ready {times.request_to_ready * 1e3:.0f} ms after the request"
        )

    def _measure(
        self, run: Run, limits: StageLimits, stage: Callable[[str, float], None], times: StageTimes
    ) -> tuple[TargetArray, int]:
        """Targets from a picture that was taken for the controller's present request, and its number.

        A request that falls and rises meanwhile (the door was clamped anew) makes the picture worthless.
        """
        handshake = self._bridge.handshake
        while True:
            stage("picture", 0.1)
            number = self._wait_for_request(run, limits)

            def over(number: int = number) -> bool:
                now = handshake.snapshot
                return now.request_number != number or not now.accepts_submission

            found = run.wait_for(
                "localization",
                limits.picture,
                "no picture of the door was localized; check that the camera sends pictures on "
                "camera/image_raw and that /door_localizer is active",
                over,
            )
            if found is not None:
                times.picture_to_pose = run.times["localization"] - seconds_of(found.header.stamp)
                stage("pose", 0.3)
                targets = run.wait_for(
                    "targets",
                    limits.targets,
                    "no targets came for the door's pose; check that /path_generator is active",
                    over,
                )
                if targets is not None:
                    times.pose_to_targets = run.times["targets"] - run.times["localization"]
                    return targets, number
            run.forget()

    def _wait_for_request(self, run: Run, limits: StageLimits) -> int:
        """Number of the controller's request; from its beginning on pictures count."""
        handshake = self._bridge.handshake
        run.wait_until(
            lambda: handshake.snapshot.accepts_submission,
            limits.request,
            "the controller does not ask for targets; check that its program runs and the door is clamped",
        )
        snapshot = handshake.snapshot
        requested = snapshot.times.get(HandshakeState.REQUESTED.value, snapshot.since)
        run.not_before = time.time() - (time.monotonic() - requested)
        return snapshot.request_number

    def _announced(self, run: Run) -> dict[str, float] | None:
        """Times of the handshake once ready went up for the run; raises when the run ended before."""
        snapshot = self._bridge.handshake.snapshot
        outcome = self._bridge.handshake.outcome(run.run_id)
        if snapshot.run_id == run.run_id and HandshakeState.READY.value in snapshot.times:
            return snapshot.times
        if outcome is not None:
            self._refuse_unless(False, outcome.reason, outcome.error_code)
        return None

    def _fetch_recipe(self, run: Run, limits: StageLimits) -> Any:
        missing = "the recipe database does not answer; check that /recipe_database is active"
        request = GetRecipe.Request(door_id=run.door_id, run_id=run.run_id)
        asked: list[Any] = []

        def answered() -> Any:
            # A database that was restarted a moment ago may miss the first request.
            if self._get_recipe.service_is_ready() and time.monotonic() - self._asked_at > ASK_AGAIN:
                self._asked_at = time.monotonic()
                asked.append(self._get_recipe.call_async(request))
                asked[-1].add_done_callback(lambda _: run.notify())
            return next((future for future in asked if future.done()), None)

        self._asked_at = float("-inf")
        response = run.wait_until(answered, limits.recipe, missing).result()
        self._refuse_unless(response.success, response.message, response.error_code)
        return response.recipe

    @staticmethod
    def _refuse_unless(good: bool, reason: str, code: int) -> None:
        if not good:
            raise StageRefusedError(reason, code)
