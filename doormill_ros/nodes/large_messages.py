"""Room for pictures on their way from a process to others."""

from __future__ import annotations

import os

from doormill_ros.resources import resource

#: What Fast DDS reads its settings from, in this release and in older ones.
_SETTINGS = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")


def make_room_for_pictures() -> None:
    """Let this process send pictures through shared memory in one go; to be called before rclpy.init.

    Settings of the user's own are left alone; other DDS implementations do not look at them.
    """
    if not any(name in os.environ for name in _SETTINGS):
        os.environ[_SETTINGS[0]] = str(resource("config/fastdds.xml"))
