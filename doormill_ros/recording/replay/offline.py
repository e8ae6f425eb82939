"""Replay a recorded run straight through the domain code, without ROS."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.graph.two_robots import FIRST, SHARE_OF, robot_of
from doormill_ros.cell.places.layout import CAMERA, CellLayout, load_layout
from doormill_ros.errors import DoormillError
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.errors import LocalizationError, StalePicture
from doormill_ros.localization.sensors.agreement import check_agreement
from doormill_ros.localization.sensors.errors import SensorsDisagree
from doormill_ros.localization.sensors.registry import SENSORS, registered
from doormill_ros.localization.sensors.sensed_door import SensedDoor
from doormill_ros.localization.sensors.sensor import DoorSensor
from doormill_ros.messages.camera_info import camera_of
from doormill_ros.messages.from_message import recipe_of, transform_of
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.pipeline.look import look
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.pipeline.sense import sense
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recording.replay.answer import (
    LOCALIZATION_STAGE,
    SENSOR_STAGE,
    STAGES,
    TARGET_FILE_STAGE,
    TARGETS_STAGE,
    Answer,
    kept,
    localization_answer,
    localization_of,
    of_robot,
    pictureless,
    refusal,
    result_answer,
    sensed_answer,
    sensed_of,
    target_file_answer,
    targets_answer,
)
from doormill_ros.recording.replay.recorded_run import RecordedRun, RecordedShare
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.units import ns_to_s

LAST_REPLAYED = 399  #: recipe, localization and path; what the controller refuses depends on the controller
OFFLINE_STAGES = STAGES[1:]  #: the recipe is what was recorded


@dataclass(frozen=True)
class OfflineOptions:
    """What a replay may take from elsewhere than the recording.

    Attributes:
        robot: Robot description; empty for the one of config/cell.yaml.
        robot_model: Compliance model; empty for the one that the recording names.
        database: Recipe database that is asked for doors that were refused as unknown; empty for
            one that holds the shipped recipes only.
    """

    robot: str = ""
    robot_model: str = ""
    database: str = ""


def replay_offline(run: RecordedRun, options: OfflineOptions | None = None) -> list[Answer]:
    """What every stage answers now to the recorded input of that stage."""
    options = options or OfflineOptions()
    if run.recipe is None:
        return _without_recipe(run, options)
    found = [_localize(run, recorded_ns, message) for recorded_ns, message in run.localizations]
    doors = [_sense(run, message) for message in run.sensed]
    found += [answer for answer, _ in doors]
    for robot, share in sorted(run.shares.items()):
        found += [of_robot(robot, answer) for answer in _mill(run, robot, share, options)]
    if run.result is not None:
        found.append(_result(run, found, [door for _, door in doors if door is not None]))
    return found


def _without_recipe(run: RecordedRun, options: OfflineOptions) -> list[Answer]:
    """A door that the database did not know."""
    with RecipeDatabase(options.database or "sqlite://") as database:
        if not options.database:
            database.add_shipped()
        try:
            database.get(run.door_id)
        except DoormillError as error:
            return [result_answer(False, error.code, f"door {run.door_id}: {error.message}")]
    # The door is known now; a run that broke off for another reason cannot be repeated from here.
    if run.result.error_code < 200:
        return [result_answer(True, 0, "")]
    return [_as_recorded(run, "the run ended before it had a recipe")]


@lru_cache(maxsize=1)
def _cell() -> tuple[CellLayout, CameraModel]:
    return load_layout(), load_camera()


def _localize(run: RecordedRun, recorded_ns: int, message: Any) -> Answer:
    """Localize the picture that a recorded localization came from."""
    stamp_ns = nanoseconds_of(message.header.stamp)
    layout, mounted = _cell()
    if stamp_ns in run.readings:
        return _of_reading(run, stamp_ns, layout)
    picture = run.pictures.get(stamp_ns)
    if pictureless(message):
        return kept(localization_of(message))
    if picture is None:
        return refusal(LOCALIZATION_STAGE, stamp_ns, 0, "the bag holds no picture of this time")
    info = run.camera_infos.get(stamp_ns)
    stale = message.error_code == StalePicture.code
    age = ns_to_s(recorded_ns - stamp_ns) - message.duration if stale else 0.0
    try:
        camera = None if info is None else camera_of(info, mounted)
        found = look(picture, camera, layout, run.recipe, age=age)
    except LocalizationError as error:
        return refusal(LOCALIZATION_STAGE, stamp_ns, error.code, error.message)
    return localization_answer(
        stamp_ns, found.T_base_door, found.offset, found.covariance, found.residual, found.quality
    )


def _of_reading(run: RecordedRun, stamp_ns: int, layout: CellLayout) -> Answer:
    """What the first sensor finds in a recorded reading, where that is not the camera."""
    reading = run.readings[stamp_ns]
    try:
        found = sense(reading, _sensor(reading.sensor), run.recipe)
    except LocalizationError as error:
        return refusal(LOCALIZATION_STAGE, stamp_ns, error.code, error.message)
    offset = layout.offset_of(found.T_base_door, run.recipe.width)
    return localization_answer(stamp_ns, found.T_base_door, offset, found.covariance, 0.0, found.quality)


@lru_cache(maxsize=8)
def _sensor(name: str) -> DoorSensor:
    return SENSORS[registered([name])[0]]()


def _sense(run: RecordedRun, message: Any) -> tuple[Answer, SensedDoor | None]:
    """What one of several sensors finds in what it took then."""
    stamp_ns, name = nanoseconds_of(message.header.stamp), str(message.sensor)
    try:
        if stamp_ns in run.readings:
            estimate = sense(run.readings[stamp_ns], _sensor(name), run.recipe)
            door = SensedDoor(name, estimate.T_base_door, estimate.covariance, estimate.sees)
        elif stamp_ns in run.pictures:
            door = _seen(run, stamp_ns)
        elif pictureless(message):
            return kept(sensed_of(message)), None
        else:
            return refusal(SENSOR_STAGE, stamp_ns, 0, "the bag holds no reading of this time"), None
    except LocalizationError as error:
        return refusal(SENSOR_STAGE, stamp_ns, error.code, error.message), None
    return sensed_answer(stamp_ns, door), door


def _seen(run: RecordedRun, stamp_ns: int) -> SensedDoor:
    """Where the camera has the door."""
    layout, mounted = _cell()
    info = run.camera_infos.get(stamp_ns)
    found = look(
        run.pictures[stamp_ns], None if info is None else camera_of(info, mounted), layout, run.recipe
    )
    return SensedDoor(CAMERA, found.T_base_door, found.whole_covariance, found.sees)


_setup = lru_cache(maxsize=8)(load_setup)


def _mill(run: RecordedRun, robot: str, share: RecordedShare, options: OfflineOptions) -> list[Answer]:
    """Targets of a robot and the file of the first that are accepted."""
    found: list[Answer] = []
    for message in share.targets:
        answer, program = _generate(run, robot, message, options)
        found.append(answer)
        if program is not None and not any(a.topic == TARGET_FILE_STAGE for a in found):
            found.extend(_target_file(run, share, answer.stamp_ns, program))
    return found


def _generate(
    run: RecordedRun, robot: str, message: Any, options: OfflineOptions
) -> tuple[Answer, MillingProgram | None]:
    """Generate the program for the recorded pose that a recorded target list came from."""
    stamp_ns = nanoseconds_of(message.header.stamp)
    pose = run.poses.get(stamp_ns)
    if pose is None:
        return refusal(TARGETS_STAGE, stamp_ns, 0, "the bag holds no pose of this time"), None
    model_name = options.robot_model or message.robot_model
    try:
        setup = _setup(options.robot, model_name, SHARE_OF.get(robot, ""))
        planned = plan(recipe_of(run.recipe), transform_of(pose), setup)
    except DoormillError as error:
        return refusal(TARGETS_STAGE, stamp_ns, error.code, error.message), None
    program = planned.program
    return targets_answer(stamp_ns, program, planned.time, model_name), program


def _target_file(
    run: RecordedRun, share: RecordedShare, stamp_ns: int, program: MillingProgram
) -> list[Answer]:
    """Render the target file, when the recorded run came so far."""
    if not run.handed_over(share):
        return []
    data = run.in_recorded_form(share, render_target_file(program, run.run_id))
    # A bag without the file's content has its checksum.
    return [target_file_answer(stamp_ns, data, by_line=bool(share.target_files))]


def _result(run: RecordedRun, found: list[Answer], doors: list[SensedDoor]) -> Answer:
    """How the run ends by what the stages answer now."""
    for topic in (LOCALIZATION_STAGE, SENSOR_STAGE, TARGETS_STAGE):
        refused = _refused(run, [a for a in found if a.stage == topic])
        if refused is not None:
            return result_answer(False, refused.error_code, _told(run, refused))
        if topic == SENSOR_STAGE:
            try:
                check_agreement(_first_told(run, doors))
            except SensorsDisagree as error:
                return result_answer(False, error.code, f"door {run.door_id}: {error.message}")
    if run.result.error_code <= LAST_REPLAYED:
        return result_answer(True, 0, "")
    return _as_recorded(run, f"what ended the run (code {run.result.error_code}) is no stage's answer")


def _refused(run: RecordedRun, answers: list[Answer]) -> Answer | None:
    """The answer of a stage that ended the run."""
    if not run.shared:
        return next((a for a in answers[:1] if not a.accepted), None)
    # A robot may have asked for another picture before the other one was ready.
    served = {a.topic for a in answers if a.accepted}
    refused = [a for a in answers if a.topic not in served]
    named = (a for a in refused if SHARE_OF.get(robot_of(a.topic)) == _named(run))
    return next(named, refused[0] if refused else None)


def _named(run: RecordedRun) -> str:
    """Which of two robots a run's result names: where both refuse a door, the one that was heard first."""
    return next((name for name in SHARE_OF.values() if f": {name} robot: " in run.result.message), FIRST)


def _told(run: RecordedRun, refused: Answer) -> str:
    """How the run's result tells of a refusal."""
    said = f"door {run.door_id}: {refused.values['reason']}"
    if not run.shared:
        return said
    return f"door {run.door_id}: {SHARE_OF.get(robot_of(refused.topic)) or _named(run)} robot: {said}"


def _first_told(run: RecordedRun, doors: list[SensedDoor]) -> list[SensedDoor]:
    """The first that each sensor told, in the order of the run's sensors."""
    by_name = {door.sensor: door for door in reversed(doors)}
    return [by_name[name] for name in run.sensors if name in by_name]


def _as_recorded(run: RecordedRun, reason: str) -> Answer:
    """The recorded result, marked as not repeated."""
    result = run.result
    answer = result_answer(result.success, result.error_code, result.message)
    return replace(answer, not_compared=f"{reason}; replay --live repeats it where it can")
