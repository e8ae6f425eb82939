"""Executables start nodes without the collector, and without texts, generators and sources that nobody asks for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from doormill_ros.nodes.process import executable

LIMIT = 120.0  # s
#: A module of a node, as `run` loads it: what it finds when it is loaded, when it runs, and what it logs.
PROBE = """
import gc, sys
loading = gc.isenabled()

def main():
    import rclpy
    from scipy.ndimage import sobel
    from std_msgs.msg import String
    running, frozen = gc.isenabled(), gc.get_freeze_count()
    with rclpy.init(args=["probe"]):
        node = rclpy.create_node("probe")
        node.create_publisher(String, "words", 1)
        node.get_logger().info("logged here")
        node.destroy_node()
    print(loading, running, frozen > 1000, "rosidl_parser.parser" in sys.modules, "axis" in sobel.__doc__)
    assert sobel([0.0, 1.0, 2.0])[1] == 2.0
    return 3
"""
START = """
import importlib.util, sys
from doormill_ros.nodes.process import executable
spec = importlib.util.spec_from_file_location("doormill_ros.nodes.probe", sys.argv[1])
sys.meta_path.insert(0, type("", (), {"find_spec": staticmethod(lambda name, *_: spec if name == spec.name else None)}))
sys.exit(executable.probe())
"""


def test_a_node_is_loaded_and_run_without_what_it_does_not_need(tmp_path: Path) -> None:
    module = tmp_path / "probe.py"
    module.write_text(PROBE, encoding="utf-8")
    told = subprocess.run(
        [sys.executable, "-c", START, module],
        env={
            **os.environ,
            "RCUTILS_CONSOLE_OUTPUT_FORMAT": "{file_name} {function_name} {line_number} {message}",
        },
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
    assert told.returncode == 3, told.stderr
    assert told.stdout.split() == ["False", "True", "True", "False", "False"]
    line = 1 + PROBE.splitlines().index('        node.get_logger().info("logged here")')
    assert f"{module} main {line} logged here" in told.stderr


def test_an_executable_is_found_by_its_name_and_nothing_else_is() -> None:
    assert executable.path_generator.args == ("path_generator",)
    with pytest.raises(AttributeError):
        executable.__path__
