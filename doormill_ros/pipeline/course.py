"""The course of a run: takes one door through all stages and tells how that ended."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.cell.errors import StageRefusedError
from doormill_ros.cell.run import Run, StageLimits
from doormill_ros.cell.summary import StageDurations
from doormill_ros.errors import DoormillError
from doormill_ros.pipeline.partners import Handover, RecipeAnswer, Recipes, Targets
from doormill_ros.units import m_to_mm, s_to_ms

ASK_AGAIN = 1.0  # s
#: States that a run which was handed over can only reach once the controller has ended it.
ENDED = (HandshakeState.DONE, HandshakeState.FAILED, HandshakeState.REQUESTED)


@dataclass
class RunEnd:
    """How a run ended; what it did not reach stays empty.

    Attributes:
        run_id: Which run.
        door_id: Its door.
        success: The door is milled.
        error_code: Code of what ended it, 0 on success.
        message: What happened; for a refusal what is wrong and what to do.
        target_file: Path of the copy; empty after a refusal.
        sha256: Of the target file; empty after a refusal.
        recipe_version: Of the recipe that was milled.
        largest_correction: Of the program [m].
        times: How long each stage took.
    """

    run_id: str
    door_id: str
    success: bool = False
    error_code: int = 0
    message: str = ""
    target_file: str = ""
    sha256: str = ""
    recipe_version: int = 0
    largest_correction: float = 0.0
    times: StageDurations = field(default_factory=StageDurations)

    def refuse(self, error_code: int, reason: str) -> None:
        """The run came to nothing."""
        self.success = False
        self.error_code = error_code
        self.message = f"door {self.door_id}: {reason}"
        self.target_file = self.sha256 = ""


class Course:
    """A run from the recipe to the end of milling.

    Args:
        run: The run in hand, to which others deliver what the stages answer.
        recipes: Where its recipe comes from.
        handover: The link to the controller.
        limits: How long it waits for each stage.
        tell: Called with each stage's name and the share of the run that is done, 0..1.

    Attributes:
        end: How it ended, as far as it got.
    """

    def __init__(
        self,
        run: Run,
        recipes: Recipes,
        handover: Handover,
        limits: StageLimits,
        tell: Callable[[str, float], None] = lambda stage, progress: None,
    ) -> None:
        self._run = run
        self._recipes = recipes
        self._handover = handover
        self._limits = limits
        self._tell = tell
        self.end = RunEnd(run.run_id, run.door_id)

    def mill(self) -> RunEnd:
        """Go through all stages; what ends the run before is told, not raised."""
        try:
            self._tell("recipe", 0.0)
            self.end.recipe_version = self._fetch_recipe()
            targets, request_number = self._measure()
            self.end.largest_correction = targets.largest_correction
            data = self._handover.submit(targets, request_number)
            self._tell("targets", 0.4)
            path = self._announce(data)
            self._watch_milling()
            self._succeed(targets, data, path)
        except StageRefusedError as error:
            self.end.refuse(error.stage_code, error.message)
        except DoormillError as error:
            self.end.refuse(error.code, error.message)
        return self.end

    def _note(self, **times: float) -> None:
        self.end.times = replace(self.end.times, **times)

    def _fetch_recipe(self) -> int:
        """Version of the recipe that the database has made known under the run's id."""
        run, clock = self._run, self._run.clock.monotonic
        heard: list[RecipeAnswer] = []
        asked_at = float("-inf")

        def hear(answer: RecipeAnswer) -> None:
            heard.append(answer)
            run.notify()

        def answered() -> bool:
            # A database that was restarted a moment ago may miss the first request.
            nonlocal asked_at
            if not heard and clock() - asked_at > ASK_AGAIN and self._recipes.ready:
                asked_at = clock()
                self._recipes.ask(run.door_id, run.run_id, hear)
            return bool(heard)

        missing = "the recipe database does not answer; check that /recipe_database is active"
        run.wait_until(answered, self._limits.recipe, missing)
        answer = heard[0]
        if not answer.accepted:
            raise StageRefusedError(answer.reason, answer.error_code)
        return answer.version

    def _measure(self) -> tuple[Targets, int]:
        """Targets from a picture that was taken for the controller's present request, and its number.

        A request that falls and rises meanwhile (the door was clamped anew) makes the picture worthless.
        """
        run, handshake = self._run, self._handover.handshake
        while True:
            self._tell("picture", 0.1)
            number = self._wait_for_request()

            def over(number: int = number) -> bool:
                now = handshake.snapshot
                return now.request_number != number or not now.accepts_submission

            localized = run.wait_for(
                "localization",
                self._limits.picture,
                "no picture of the door was localized; check that the camera sends pictures on "
                "camera/image_raw and that /door_localizer is active",
                over,
            )
            if localized is not None:
                self._note(picture_to_pose=run.times["localization"] - run.pictured["localization"])
                self._tell("pose", 0.3)
                targets = run.wait_for(
                    "targets",
                    self._limits.targets,
                    "no targets came for the door's pose; check that /path_generator is active",
                    over,
                )
                if targets is not None:
                    self._note(pose_to_targets=run.times["targets"] - run.times["localization"])
                    return targets, number
            run.forget()

    def _wait_for_request(self) -> int:
        """Number of the controller's request; from its beginning on pictures count."""
        run, handshake = self._run, self._handover.handshake
        run.wait_until(
            lambda: handshake.snapshot.accepts_submission,
            self._limits.request,
            "the controller does not ask for targets; check that its program runs and the door is clamped",
        )
        snapshot = handshake.snapshot
        requested = snapshot.times.get(HandshakeState.REQUESTED.value, snapshot.since)
        run.not_before = run.clock.wall() - (run.clock.monotonic() - requested)
        return snapshot.request_number

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
        run.wait_until(
            lambda: handshake.snapshot.state in ENDED,
            limits.milling,
            "the controller did not report the end of milling; look at its pendant",
        )
        end = handshake.snapshot
        if end.state is not HandshakeState.DONE:
            raise MillingFaultError(end.reason)
        self._tell("milling", 1.0)

    def _succeed(self, targets: Targets, data: bytes, path: Path) -> None:
        end = self.end
        end.success = True
        end.target_file = str(path)
        end.sha256 = hashlib.sha256(data).hexdigest()
        end.message = (
            f"door {end.door_id} milled: {len(targets.targets)} targets, largest correction "
            f"{m_to_mm(targets.largest_correction):.3f} mm, ready {s_to_ms(end.times.request_to_ready):.0f} ms "
            "after the request"
        )
