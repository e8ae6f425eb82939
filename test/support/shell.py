"""Shell lines of pages, run as a reader would."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

from support.source_tree import ROOT


def run_in_shell(script: str, folder: Path, **kwargs: object) -> subprocess.Popen[str]:
    """A bash of its own group in a folder, without what the tests' environment set up; `. ./activate` is the tree's."""
    environment = {
        k: v for k, v in os.environ.items() if k in ("PATH", "HOME", "LANG", "TMPDIR", "XDG_DATA_HOME")
    }
    environment |= {
        k: os.environ[k] for k in ("ROS_DOMAIN_ID", "ROS_DISTRO", "AMENT_PREFIX_PATH") if k in os.environ
    }
    script = "set -e\n" + script.replace(". ./activate", f". {ROOT}/activate")
    return subprocess.Popen(
        ["bash", "-c", script],
        cwd=folder,
        env=environment,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        **kwargs,
    )


def output_of(script: str, folder: Path, limit: float) -> str:
    """What shell lines print that have to end well within a limit [s]; nothing of them is left running."""
    process = run_in_shell(script, folder)
    try:
        output, _ = process.communicate(timeout=limit)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 0, output
    return str(output)
