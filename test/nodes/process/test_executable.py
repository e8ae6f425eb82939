"""Executables load their nodes without the collector, which keeps what is loaded out of its rounds."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from doormill_ros.nodes.process import executable
from support.waiting import LIMIT

#: A module of a node, as `run` loads it: what it finds when it is loaded and when it runs.
PROBE = """
import gc
loading = gc.isenabled()

def main():
    print(loading, gc.isenabled(), gc.get_freeze_count() > 1000)
    return 3
"""
START = """
import importlib.util, sys
from doormill_ros.nodes.process import executable
spec = importlib.util.spec_from_file_location("doormill_ros.nodes.probe", sys.argv[1])
sys.meta_path.insert(0, type("", (), {"find_spec": staticmethod(lambda name, *_: spec if name == spec.name else None)}))
sys.exit(executable.probe())
"""


def test_a_node_is_loaded_without_the_collector_and_runs_with_it(tmp_path: Path) -> None:
    module = tmp_path / "probe.py"
    module.write_text(PROBE, encoding="utf-8")
    told = subprocess.run(
        [sys.executable, "-c", START, module], capture_output=True, text=True, timeout=LIMIT
    )
    assert told.returncode == 3, told.stderr
    assert told.stdout.split() == ["False", "True", "True"]


def test_an_executable_is_found_by_its_name_and_nothing_else_is() -> None:
    assert executable.path_generator.args == ("path_generator",)
    with pytest.raises(AttributeError):
        executable.__path__
