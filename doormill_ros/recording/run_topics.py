"""Topics that tell of a run, relative to the cell's namespace or to that of one of two robots below it."""

from __future__ import annotations

from doormill_ros.cell.two_robots import FIRST, SECOND

RECIPE, PICTURE, CAMERA_INFO = "door/recipe", "camera/image_raw", "camera/camera_info"
COMPRESSED = f"{PICTURE}/compressed"  #: counts where the picture itself is not in the bag
POSE, LOCALIZATION, TARGETS = "door/pose", "door/localization", "path/targets"
READING, SENSED = "sensors/reading", "sensors/localization"
TARGET_FILE, RUN_RESULT = "abb/target_file", "run/result"
STATUS = "abb/status"
#: Namespaces of two robots below the cell's, with the shares that they mill.
SHARE_OF = {"robot1": FIRST, "robot2": SECOND}


def robot_of(topic: str) -> str:
    """Namespace of the robot whose topic it is; empty for one of the cell's."""
    return next((name for name in topic.split("/")[:-2] if name in SHARE_OF), "")
