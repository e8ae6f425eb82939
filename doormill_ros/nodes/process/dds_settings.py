"""Settings of Fast DDS for this process; to be made before rclpy.init.

Settings of the user's own are left alone; other DDS implementations do not look at these.
"""

from __future__ import annotations

import os

from doormill_ros.resources import resource

#: What Fast DDS reads its settings from, in this release and in older ones.
_SETTINGS = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
_NODES, _PICTURES = "config/fastdds_nodes.xml", "config/fastdds.xml"


def repair_soon() -> None:
    """Let what is lost on the wire be sent again within a tenth of a second, an announcement within half a one.

    By default both take three seconds.
    """
    if not any(name in os.environ for name in _SETTINGS):
        os.environ[_SETTINGS[0]] = str(resource(_NODES))


def make_room_for_pictures() -> None:
    """Let this process send pictures through shared memory in one go, and repair soon."""
    # Who started this process may have handed on what it took for itself.
    if os.environ.get(_SETTINGS[0]) == str(resource(_NODES)):
        del os.environ[_SETTINGS[0]]
    if not any(name in os.environ for name in _SETTINGS):
        os.environ[_SETTINGS[0]] = str(resource(_PICTURES))
