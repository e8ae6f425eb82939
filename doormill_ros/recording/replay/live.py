"""Repeat a recorded run with nodes that answer: what is played to them, when, and which answers count."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Protocol

from doormill_ros.localization.errors import StalePicture
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.recording.replay.answer import (
    SENSOR_STAGE,
    STAGES,
    Answer,
    kept,
    localization_of,
    pictureless,
    recipe_of,
    result_answer,
    target_file_answer,
    targets_of,
)
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.units import ns_to_s

#: What a live replay compares: of sensors beside the first one only whether they agree, by how the run ends.
LIVE_STAGES = tuple(topic for topic in STAGES if topic != SENSOR_STAGE)


class AnsweringCell(Protocol):
    """The nodes that a run is played to; each method that waits raises StageTimeoutError after its limit."""

    def send_goal(self, door_id: str) -> None:
        """Ask for a door and wait until that was taken."""

    def cancel_goal(self) -> None:
        """Give the door up."""

    def wait_for_recipe(self) -> Any:
        """The recipe message of the run; None when the run ended without one."""

    def wait_for_request(self) -> None:
        """Until the bridge has seen the controller's request, or the run ended."""

    def show_picture(self, data: Sequence[tuple[str, bytes]], age: float) -> tuple[Any, Any]:
        """Send serialized messages with their topics under a new stamp, `age` seconds old; what was answered to them.

        Returns:
            Localization and targets as messages; no targets where the picture was refused.
        """

    def went_on(self) -> bool:
        """Whether the run went on with a picture, or ended, after a moment's grace."""

    def wait_for_result(self) -> Any:
        """The result of the goal."""

    def wait_for_target_file(self, unless: Callable[[Any], bool]) -> str | None:
        """The target file that the bridge wrote; None once the goal's result fulfils `unless`."""


class LiveRun:
    """One run that is repeated.

    Args:
        run: What was recorded.
        cell: To whom it is played.
        rate: Times the recorded speed; infinite to wait for answers only.
        to_the_end: Wait for the end of the run; otherwise cancel it when the stages have answered.
    """

    def __init__(self, run: RecordedRun, cell: AnsweringCell, rate: float, to_the_end: bool) -> None:
        self._run = run
        self._cell = cell
        self._rate = rate
        self._to_the_end = to_the_end

    def replay(self, begin: Callable[[], None], check_age: Callable[[bool], None]) -> list[Answer]:
        """Repeat the run; the answers under the stamps of the recorded pictures.

        Args:
            begin: Called when the recipe is in hand; starts the controller.
            check_age: Called with True before a picture that was refused for its age, with False after it.

        Raises:
            StageTimeoutError: A node does not answer.
        """
        self._cell.send_goal(self._run.door_id)
        recipe = self._cell.wait_for_recipe()
        answers = []
        if recipe is not None:
            answers.append(recipe_of(recipe))
            begin()
        if self._run.recipe is not None and recipe is not None:
            answers += self._pictures(check_age)
        return answers + self._end("" if recipe is None else recipe.run_id)

    def _pictures(self, check_age: Callable[[bool], None]) -> list[Answer]:
        """Send what was localized when it was recorded; what the stages answer."""
        run = self._run
        answers: list[Answer] = []
        last = nanoseconds_of(run.recipe.header.stamp)
        if any(level for _, level in run.requests):
            # A picture from before the request would not count for the run.
            self._cell.wait_for_request()
        for recorded_ns, message in run.localizations:
            stamp_ns = nanoseconds_of(message.header.stamp)
            if pictureless(message):
                answers.append(kept(localization_of(message)))
                continue
            if stamp_ns not in run.pictures and stamp_ns not in run.readings:
                continue
            if math.isfinite(self._rate):
                time.sleep(ns_to_s(max(0, stamp_ns - last)) / self._rate)
            last = stamp_ns
            stale = message.error_code == StalePicture.code
            check_age(stale)
            age = ns_to_s(recorded_ns - stamp_ns) - message.duration if stale else 0.0
            found = self._picture(stamp_ns, age)
            check_age(False)
            # A run takes the first picture of its request; that may have come before the bridge waited for it.
            while not answers and not stale and not self._cell.went_on():
                found = self._picture(stamp_ns, age)
            answers += [replace(answer, stamp_ns=stamp_ns) for answer in found]
        return answers

    def _picture(self, stamp_ns: int, age: float) -> list[Answer]:
        """Send one recorded picture; the answers to it."""
        run = self._run
        data = [(topic, data) for (topic, at), data in run.serialized.items() if at == stamp_ns]
        data += run.beside(stamp_ns)
        localization, targets = self._cell.show_picture(data, age)
        answers = [localization_of(localization)]
        return answers if targets is None else [*answers, targets_of(targets)]

    def _end(self, run_id: str) -> list[Answer]:
        """The target file and how the run ended."""
        run, answers = self._run, []
        end = self._cell.wait_for_result() if self._to_the_end else None
        if run.handed_over(run.share()):
            # It comes on another way than the result and may be heard after it.
            text = self._cell.wait_for_target_file(self._ended_otherwise)
            if text is not None:
                answers.append(self._target_file(text.replace(run_id, run.run_id)))
        if end is not None:
            answers.append(result_answer(end.success, end.error_code, end.message))
            return answers
        self._cell.cancel_goal()
        if run.result is not None:
            code = run.result.error_code
            answers.append(
                replace(
                    result_answer(run.result.success, code, run.result.message),
                    not_compared=f"what ended the run (code {code}) cannot be repeated",
                )
            )
        return answers

    def _ended_otherwise(self, end: Any) -> bool:
        """The run was refused, earlier or otherwise than when it was recorded."""
        return not end.success and end.error_code != self._run.result.error_code

    def _target_file(self, text: str) -> Answer:
        """The file that the bridge wrote, under the recorded run's name."""
        share = self._run.share()
        accepted = next(m for m in share.targets if m.accepted)
        stamp_ns = nanoseconds_of(accepted.header.stamp)
        data = self._run.in_recorded_form(share, text.encode("ascii"))
        return target_file_answer(stamp_ns, data, by_line=bool(share.target_files))
