"""Every topic of the cell by its name, relative to the cell's namespace or to that of one of two robots below it."""

from __future__ import annotations

from collections.abc import Iterable

IMAGE = "camera/image_raw"
COMPRESSED = f"{IMAGE}/compressed"
CAMERA_INFO = "camera/camera_info"
CAMERA_MOVED = "camera/moved"
DOOR_POSE = "door/pose"
DOOR_LOCALIZATION = "door/localization"
DOOR_OVERLAY = "door/overlay"
SENSOR_READING = "sensors/reading"
SENSOR_LOCALIZATION = "sensors/localization"
DOOR_RECIPE = "door/recipe"
PATH_TARGETS = "path/targets"
PATH_NOMINAL = "path/nominal"
PATH_CORRECTED = "path/corrected"
PATH_MARKERS = "path/markers"
CELL_BODIES = "cell/bodies"
PATH_JOINT_STATES = "path/joint_states"
ROBOT_DESCRIPTION = "robot_description"
ABB_STATUS = "abb/status"
ABB_REQUEST = "abb/request"
ABB_READY = "abb/ready"
CONTROLLER_STATE = "abb/controller_state"
ABB_TARGET_FILE = "abb/target_file"
SPINDLE_LOAD = "abb/spindle_load"
RUN_RESULT = "run/result"
SHARE_GO = "share/go"
SHARE_RESULT = "share/result"  #: what a robot of two has in place of its run's
DOOR_PLACEMENT = "simulation/door_placement"
EXECUTED_PATH = "simulation/executed_path"
UNCORRECTED_PATH = "simulation/uncorrected_path"
MILLED_DOOR = "simulation/milled_door"
DOOR_INSPECTION = "door/inspection"
MODEL_INSPECTED = "model/inspected"
MODEL_VERDICT = "model/verdict"
RUNS_VERDICT = "model/runs_verdict"
RUN_VERDICT = "simulation/verdict"
DIAGNOSTICS = "/diagnostics"  #: wherever the cell is


def name_of(topic: str, names: Iterable[str]) -> str:
    """Which of the names a topic has that is called in full, whichever namespace it is in; empty for none of them."""
    return next((name for name in names if topic.endswith(f"/{name}")), "")
