"""What asks ROS' own launch and command line is collected only where they are installed; the wheels bring neither."""

from __future__ import annotations

import shutil
from importlib.util import find_spec

collect_ignore = [] if find_spec("launch_ros") else ["test_arguments.py", "test_cell.py"]
if shutil.which("ros2") is None:
    collect_ignore.append("test_command_line.py")
