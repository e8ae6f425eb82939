"""What the cell in one process holds from the twentieth door of a shift to the last: `python bench/run.py memory`."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
from pathlib import Path

from held import Held, held_by, size_of

from doormill_ros.cell.output.run_folder import ShiftFolder
from harness import Entry, limit
from support.cell_processes import executable

DOOR, DOORS = "thesis_190_0deg", 300
WARM = 20  #: doors after which the process holds what it needs
#: What it may take more after the last door [MB], and what one door may leave on the disk [MB].
GROWTH, DISK = 20.0, 6.0
#: Handles and threads that come and go in the course of a door; one that stays with every hundredth door is more.
PASSING = 2
LIMIT = 120.0  # s, of a door
POLL = 0.5  # s


def run(doors: int = DOORS) -> list[Entry]:
    """Mill a shift with the simulated robot, each door with nodes of its own."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {
            **os.environ,
            "ROS_DOMAIN_ID": str(20 + os.getpid() % 80),
            "XDG_DATA_HOME": folder,
        }
        shift = Path(folder) / "shift"
        command = [executable("cell"), "--door", DOOR, "--doors", str(doors), "--out", str(shift)]
        with open(Path(folder) / "log", "wb") as log:
            process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, env=environment)
        try:
            warm, last = (_held_after(process, shift, door) for door in (min(WARM, doors - 2), doors - 1))
            disk = size_of(shift) / (doors - 1) / 1e6
        finally:
            process.terminate()
            process.wait()
    name = "cell in one process"
    return [
        limit(f"{name}: memory", last.memory, "MB", warm.memory + GROWTH, doors),
        limit(f"{name}: handles", last.handles, "handles", warm.handles + PASSING, doors),
        limit(f"{name}: sockets", last.sockets, "sockets", warm.sockets + PASSING, doors),
        limit(f"{name}: threads", last.threads, "threads", warm.threads + PASSING, doors),
        limit(f"{name}: disk a door", disk, "MB", DISK, doors),
    ]


def _held_after(process: subprocess.Popen[bytes], shift: Path, doors: int) -> Held:
    """What the process holds while it mills the door after so many; the last door's end would be its own."""
    end = time.monotonic() + LIMIT * doors
    while _milled(shift) < doors:
        if process.poll() is not None or time.monotonic() > end:
            raise RuntimeError(f"the shift ended or stood still before door {doors}")
        time.sleep(POLL)
    return held_by(process.pid)


def _milled(shift: Path) -> int:
    summary = ShiftFolder(shift).summary
    return len(json.loads(summary.read_text())["doors"]) if summary.exists() else 0
