"""Live replay of runs that no reference bag holds: a stale picture, a run that somebody canceled."""

from __future__ import annotations

import math

from doormill_ros.cell.errors import RunCanceledError, StageTimeoutError
from doormill_ros.localization.errors import StalePicture
from doormill_ros.nodes.replay.live_replay import LiveOptions, repeats_the_end, replay_live
from doormill_ros.recording.replay.answer import (
    LOCALIZATION_STAGE,
    RECIPE_STAGE,
    RESULT_STAGE,
    TARGET_FILE_STAGE,
    TARGETS_STAGE,
)
from doormill_ros.recording.replay.offline import replay_offline
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.recording.replay.run_reader import read_runs
from support.source_tree import ROOT

FAST = LiveOptions(rate=math.inf)
AGE = 30_000_000_000  # ns


def recorded(scenario: str) -> RecordedRun:
    (run,) = read_runs(ROOT / "bags" / scenario)
    return run


def test_a_stale_picture_is_stale_again() -> None:
    run = recorded("outside_y")
    ((recorded_ns, message),) = run.localizations
    message.error_code = StalePicture.code
    run.localizations = [(recorded_ns + AGE, message)]
    run.result.error_code = StageTimeoutError.code
    live = {a.topic: a for a in replay_live(run, FAST)}
    offline = {a.topic: a for a in replay_offline(run)}
    assert live.keys() == {RECIPE_STAGE, LOCALIZATION_STAGE, RESULT_STAGE}
    for found in (live[LOCALIZATION_STAGE], offline[LOCALIZATION_STAGE]):
        assert found.values["error_code"] == StalePicture.code
        assert "30" in found.values["reason"]
    assert live[RESULT_STAGE].not_compared


def test_a_canceled_run_is_repeated_as_far_as_it_goes() -> None:
    run = recorded("thesis_190_0deg")
    run.result.success, run.result.error_code = False, RunCanceledError.code
    assert not repeats_the_end(run)
    found = replay_live(run, FAST)
    assert [a.topic for a in found] == [
        RECIPE_STAGE,
        LOCALIZATION_STAGE,
        TARGETS_STAGE,
        TARGET_FILE_STAGE,
        RESULT_STAGE,
    ]
    assert [bool(a.not_compared) for a in found] == [False, False, False, False, True]
    assert str(RunCanceledError.code) in found[-1].not_compared


def test_a_recording_that_stopped_before_the_end_has_no_result() -> None:
    run = recorded("thesis_190_0deg")
    run.result = None
    assert [a.topic for a in replay_live(run, FAST)] == [RECIPE_STAGE, LOCALIZATION_STAGE, TARGETS_STAGE]
