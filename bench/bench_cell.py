"""Request to ready with every node a process of its own, picture included, over DDS."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from harness import Entry, entry

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "test"))

DOOR = "thesis_190_0deg"
RUNS = 12
THESIS_EXECUTION = 0.8  # s, table 4.7
STAGES = ("request_to_ready", "picture_to_pose", "pose_to_targets", "targets_to_ready")


def run() -> list[Entry]:
    """Mill one door again and again; the first run, in which everything is loaded, does not count."""
    os.environ["ROS_DOMAIN_ID"] = str(20 + os.getpid() % 80)  # nobody else's nodes
    from cell_processes import CellProcesses

    times: dict[str, list[float]] = {stage: [] for stage in STAGES}
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_DATA_HOME"] = folder
        with CellProcesses(Path(folder) / "cell") as cell:
            for number in range(RUNS + 1):
                result, _ = cell.mill(DOOR)
                if not result.success:
                    raise subprocess.SubprocessError(result.message)
                for stage in STAGES if number else ():
                    times[stage].append(getattr(result.times, stage))
    return [
        entry(
            f"cell: {stage.replace('_', ' ')}, separate processes",
            statistics.median(times[stage]),
            "s",
            "thesis, table 4.7",
            THESIS_EXECUTION,
            RUNS,
        )
        for stage in STAGES
    ]
