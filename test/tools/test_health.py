"""The command that says whether the cell is ready, on nodes that run as processes."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

from support.cell_processes import CellProcesses, executable


def health(*arguments: str) -> tuple[int, str]:
    done = subprocess.run(
        [executable("health"), *arguments], capture_output=True, text=True, timeout=300, env=dict(os.environ)
    )
    assert "Traceback" not in done.stderr
    return done.returncode, done.stdout


def test_a_running_cell_is_ready_until_a_node_is_killed(tmp_path: Path) -> None:
    status, said = health("--wait", "1")
    assert status == 1
    assert "abb_bridge: not heard of" in said
    with CellProcesses(tmp_path) as cell:
        assert health("--wait", "60") == (0, "ready\n")
        assert health("--wait", "1", "--namespace", "/cell2")[0] == 1
        cell.stop("path_generator", signal.SIGKILL)
        status, said = health("--wait", "0")
        assert status == 1
        status, said = health("--wait", "8")
        assert status == 1
        assert said.splitlines() == ["not ready", "  path_generator: not heard of for 3 s; start it"]
        cell.start("path_generator")
        assert health("--wait", "60") == (0, "ready\n")


def test_a_wrong_wait_is_refused() -> None:
    done = subprocess.run([executable("health"), "--wait", "-1"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stderr.startswith("health: argument --wait: found -1")
