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

#: What the thesis timed, and a whole door with hundreds of targets; the number of runs that count.
DOORS = {"thesis_190_0deg": 12, "standard_door": 4}
THESIS_EXECUTION = 0.8  # s, table 4.7
STAGES = ("request_to_ready", "picture_to_pose", "pose_to_targets", "targets_to_ready")


def run() -> list[Entry]:
    """Mill each door again and again; its first run, in which everything is loaded, does not count."""
    os.environ["ROS_DOMAIN_ID"] = str(20 + os.getpid() % 80)  # nobody else's nodes
    from support.cell_processes import CellProcesses

    times: dict[tuple[str, str], list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_DATA_HOME"] = folder
        with CellProcesses(Path(folder) / "cell") as cell:
            for door, runs in DOORS.items():
                for number in range(runs + 1):
                    result, _ = cell.mill(door)
                    if not result.success:
                        raise subprocess.SubprocessError(result.message)
                    for stage in STAGES if number else ():
                        times.setdefault((door, stage), []).append(getattr(result.times, stage))
    return [
        entry(
            f"cell: {stage.replace('_', ' ')}, separate processes, {door}",
            statistics.median(measured),
            "s",
            "thesis, table 4.7, a door of two hinges",
            THESIS_EXECUTION,
            len(measured),
        )
        for (door, stage), measured in times.items()
    ]
