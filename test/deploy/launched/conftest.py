"""What asks ROS' own launch is collected only where it is installed; the wheels bring none."""

from __future__ import annotations

from importlib.util import find_spec

collect_ignore = [] if find_spec("launch_ros") else ["test_cameras.py", "test_cell.py"]
