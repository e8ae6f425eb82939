"""The course of a run: takes one door through all stages and tells how that ended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

from doormill_ros.abb.handshake.state import HandshakeState, RunOutcome
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.cell.errors import StageRefusedError
from doormill_ros.cell.graph.door_sensors import node_of
from doormill_ros.cell.graph.node_names import (
    CAMERA_SIMULATOR,
    CONTROLLER_SIMULATOR,
    DOOR_SHARES,
    PATH_GENERATOR,
    RECIPE_DATABASE,
    SENSOR_SIMULATOR,
)
from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.cell.run.run import LOCALIZATION, TARGETS, Run, StageLimits
from doormill_ros.errors import DoormillError
from doormill_ros.localization.sensors.agreement import check_agreement
from doormill_ros.messages.from_message import sensed_door_of
from doormill_ros.pipeline.inspection_stage import await_inspection
from doormill_ros.pipeline.partners import Attendance, Handover, Inspector, Recipes, Targets
from doormill_ros.pipeline.recipe_stage import fetch_recipe
from doormill_ros.pipeline.run_end import RunEnd

ALONE_LIMIT = 10.0  # s
#: Nodes without which a run comes to nothing, by stage. Those of the simulation are missed only where they have been.
MILLING_NODES = (CONTROLLER_SIMULATOR,)
TARGET_NODES = (PATH_GENERATOR, *MILLING_NODES)
SIMULATED_NODES = (CAMERA_SIMULATOR, SENSOR_SIMULATOR)


def picture_nodes(sensors: Sequence[str]) -> tuple[str, ...]:
    """Nodes without which no pose of the door comes."""
    return (*map(node_of, sensors), *SIMULATED_NODES, *TARGET_NODES)


def recipe_nodes(sensors: Sequence[str]) -> tuple[str, ...]:
    """Nodes without which no run comes to an end."""
    return (RECIPE_DATABASE, *picture_nodes(sensors))


def stage_of(sensor: str) -> str:
    """The stage under which is delivered what one of several sensors found."""
    return f"{LOCALIZATION} by {sensor}"


def _missing(sensor: str) -> str:
    """What to say when a sensor told nothing."""
    if sensor == CAMERA:
        return (
            "no picture of the door was localized; check that the camera sends pictures on camera/image_raw and that "
            "/door_localizer is active"
        )
    return (
        f"{sensor} did not find the door; check that its driver sends readings of this run on sensors/reading and "
        f"that /{node_of(sensor)} is active"
    )


class Course:
    """A run from the recipe to the end of milling.

    Args:
        run: The run in hand, to which others deliver what the stages answer.
        recipes: Where its recipe comes from.
        handover: The link to the controller.
        inspector: Who measures the milled door.
        attendance: Which nodes are alive.
        limits: How long it waits for each stage.
        tell: Called with each stage's name and the share of the run that is done, 0..1.
        sensors: What finds the door; targets are made from the pose of the first one.
        may_mill: Of a robot that mills a share: whether it has been given the word; None for a robot by itself.

    Attributes:
        end: How it ended, as far as it got.
    """

    def __init__(
        self,
        run: Run,
        recipes: Recipes,
        handover: Handover,
        inspector: Inspector,
        attendance: Attendance,
        limits: StageLimits,
        tell: Callable[[str, float], None] = lambda stage, progress: None,
        sensors: Sequence[str] = (CAMERA,),
        may_mill: Callable[[], bool] | None = None,
    ) -> None:
        self._run = run
        self._may_mill = may_mill
        self._recipes = recipes
        self._handover = handover
        self._inspector = inspector
        self._attendance = attendance
        self._limits = limits
        self._sensors = tuple(sensors)
        self._recipe_nodes, self._picture_nodes = recipe_nodes(sensors), picture_nodes(sensors)
        self._tell = tell
        self.end = RunEnd(run.run_id, run.door_id)
        self._steps = 0  # of the clock, when the recipe was asked for

    def mill(self) -> RunEnd:
        """Go through all stages; what ends the run before is told, not raised."""
        try:
            self._tell("recipe", 0.0)
            self._need(self._recipe_nodes)
            self._run.wait_until(
                lambda: self._attendance.settled, ALONE_LIMIT, "two nodes of one name stay alive in this cell"
            )
            self._attendance.require(self._recipe_nodes)
            self.end.recipe_version = self._fetch_recipe()
            targets, request_number = self._measure()
            self.end.largest_correction = targets.largest_correction
            self.end.robot_model, self.end.model_version = targets.robot_model, targets.model_version
            if self._may_mill is not None:
                self._tell(TARGETS, 0.4)
                self._wait_for_the_word(self._may_mill)
            self._need(MILLING_NODES)
            self._wait_for_link()
            data = self._handover.submit(targets, request_number)
            if self._may_mill is None:
                self._tell(TARGETS, 0.4)
            path = self._announce(data)
            self._watch_milling()
            measured = await_inspection(self._run, self._inspector, self._limits.inspection)
            self.end.note_milled(len(targets.targets), data, path, measured)
        except DoormillError as error:
            self.end.refuse(error.code, error.message)
        return self.end

    def _need(self, names: tuple[str, ...]) -> None:
        """From now on the run ends when one of these nodes dies."""
        # Not by way of this course: it holds the run, whose messages would stay until the collector comes round.
        self._run.require = partial(self._attendance.require, names)

    def _note(self, **times: float) -> None:
        self.end.times = replace(self.end.times, **times)

    def _fetch_recipe(self) -> int:
        """Version of the recipe that the database has made known under the run's id."""
        self._steps = len(self._run.steps)
        return fetch_recipe(self._run, self._recipes, self._limits.recipe)

    def _measure(self) -> tuple[Targets, int]:
        """Targets from a picture that was taken for the controller's present request, and its number.

        A request that falls and rises meanwhile (the door was clamped anew) makes the picture worthless. A clock that
        is set does so too, and the recipe is made known again: by its stamp a pose is told from that of another door.
        """
        run, handshake = self._run, self._handover.handshake
        while True:
            if len(run.steps) != self._steps:
                self._need(self._recipe_nodes)
                self.end.recipe_version = self._fetch_recipe()
            self._need(self._picture_nodes)
            self._tell("picture", 0.1)
            number = self._wait_for_request()

            def over(number: int = number) -> bool:
                now = handshake.snapshot
                asks = now.accepts_submission or now.state is HandshakeState.CLEARING
                reclamped = now.request_number != number or not asks
                return reclamped or len(run.steps) != self._steps

            localized = run.wait_for(LOCALIZATION, self._limits.picture, _missing(self._sensors[0]), over)
            if localized is not None and self._agreed(over):
                self._note(picture_to_pose=run.times[LOCALIZATION] - run.pictured[LOCALIZATION])
                self._need(TARGET_NODES)
                self._tell("pose", 0.3)
                targets = run.wait_for(
                    TARGETS,
                    self._limits.targets,
                    "no targets came for the door's pose; check that /path_generator is active",
                    over,
                )
                if targets is not None:
                    self._note(pose_to_targets=run.times[TARGETS] - run.times[LOCALIZATION])
                    self._wait_for_link()
                    if not over():
                        return targets, number
            run.forget()

    def _agreed(self, over: Callable[[], bool]) -> bool:
        """Wait for what every sensor found, where there are several; False once `over` is true.

        Raises:
            SensorsDisagree: Two of them have the door in different places.
        """
        if len(self._sensors) == 1:
            return True
        doors = []
        for name in self._sensors:
            found = self._run.wait_for(stage_of(name), self._limits.picture, _missing(name), over)
            if found is None:
                return False
            doors.append(sensed_door_of(found))
        check_agreement(doors)
        return True

    def _wait_for_link(self) -> None:
        """A short break of the link is waited for: the controller may ask for the same file after it."""
        self._run.wait_until(
            lambda: self._handover.handshake.snapshot.state is not HandshakeState.CLEARING,
            self._limits.request,
            "the controller could not be reached or cleared; see what /abb_bridge reports",
        )

    def _wait_for_request(self) -> int:
        """Number of the controller's request; from its beginning on pictures count."""
        run, handshake = self._run, self._handover.handshake
        if handshake.snapshot.state is HandshakeState.MILLING:  # a file of a bridge that was killed
            run.wait_until(
                lambda: handshake.snapshot.state is not HandshakeState.MILLING,
                self._limits.milling,
                "the robot still mills the door before; look at its pendant",
            )
        run.wait_until(
            lambda: handshake.snapshot.accepts_submission,
            self._limits.request,
            "the controller does not ask for targets; check that its program runs and the door is clamped",
        )
        snapshot = handshake.snapshot
        requested = snapshot.times.get(HandshakeState.REQUESTED.value, snapshot.since)
        run.not_before = run.clock.wall() - (run.clock.monotonic() - requested)
        return snapshot.request_number

    def _wait_for_the_word(self, may_mill: Callable[[], bool]) -> None:
        """Wait while the other robot gets its targets, and for as long as it mills where it is the first."""
        limits = self._limits
        self._need((DOOR_SHARES, *TARGET_NODES))
        self._run.wait_until(
            may_mill,
            limits.picture + limits.targets + limits.ready + limits.read + limits.milling,
            f"/{DOOR_SHARES} did not give this robot the word to mill its share; look at the other robot",
        )

    def _announce(self, data: bytes) -> Path:
        """Wait until the file is written, verified and announced; path of its copy."""
        run = self._run
        try:
            times = run.wait_until(
                self._announced,
                self._limits.ready,
                "the target file was not written and verified; see abb/status",
            )
        except DoormillError:
            with suppress(OSError, DoormillError):  # the reason counts more than the copy
                self._handover.file_away(run.run_id, data)
            raise
        path = self._handover.file_away(run.run_id, data)  # the controller does not wait for the copy
        self._note(
            targets_to_ready=times["ready"] - times["writing"],
            request_to_ready=times["ready"] - times["requested"],
        )
        self._tell("ready", 0.6)
        return path

    def _announced(self) -> dict[str, float] | None:
        """Times of the handshake once ready went up for the run; raises when the run ended before."""
        run_id, handshake = self._run.run_id, self._handover.handshake
        snapshot = handshake.snapshot
        outcome = handshake.outcome(run_id)
        if snapshot.run_id == run_id and HandshakeState.READY.value in snapshot.times:
            return snapshot.times
        if outcome is not None:
            raise StageRefusedError(outcome.reason, outcome.error_code)
        return None

    def _watch_milling(self) -> None:
        """Wait until the controller has read the file and reports the end of milling."""
        run, limits, handshake = self._run, self._limits, self._handover.handshake
        outcome = run.wait_until(
            lambda: handshake.outcome(run.run_id),
            limits.read + limits.ready,  # the handshake itself gives up after limits.read
            "the controller does not read the target file",
        )
        if not outcome.handed_over:
            raise StageRefusedError(outcome.reason, outcome.error_code)
        self._tell("milling", 0.7)
        end = run.wait_until(
            lambda: self._milled(run.run_id),
            limits.milling,
            "the controller did not report the end of milling; look at its pendant",
        )
        if not end.milled:
            raise MillingFaultError(end.reason)
        self._tell("milling", 1.0)

    def _milled(self, run_id: str) -> RunOutcome | None:
        """How the milling of a run ended, None while it goes on."""
        outcome = self._handover.handshake.outcome(run_id)
        return None if outcome is None or outcome.milled is None else outcome
