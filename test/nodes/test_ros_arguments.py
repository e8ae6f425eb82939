"""What ROS 2 lets everybody say on a command line: names, topics, the level of the log; and what it cannot read."""

from __future__ import annotations

import signal
import subprocess
from dataclasses import replace
from pathlib import Path

from doormill_ros.cell.errors import NodeDeadError
from doormill_ros.nodes import topics
from support.cell_processes import NODES, CellProcesses, executable

DOOR = "thesis_190_0deg"
LIMIT = 120.0  # s


def test_a_node_under_another_name_with_other_topics_does_its_work(tmp_path: Path) -> None:
    others = [name for name in NODES if name not in ("door_localizer", "bag_recorder")]
    with CellProcesses(tmp_path / "cell", nodes=others) as cell:
        overlays = cell.subscribe(replace(topics.DOOR_OVERLAY, name="seen/overlay"))
        renamed = ("-r", "__node:=eye", "-r", "door/overlay:=seen/overlay", "--log-level", "debug")
        cell.start("door_localizer", *renamed, "-p", "overlay_steps:=1", "-p", "eyes:overlay_step:=1")
        cell.wait_until_active("eye")
        result, _ = cell.mill(DOOR)
        assert result.success, result.message
        cell.wait(lambda: overlays)
        log = cell.log("door_localizer")
        assert "[DEBUG]" in log
        assert "no parameter overlay_steps of /eye" in log
        assert log.count("overlay_step is meant") == 1
        assert log.count("there is no node eyes in this process") == 1
        # What the bridge watches is what a node does in the cell, however it is called.
        cell.stop("door_localizer", signal.SIGKILL)
        cell.wait(lambda: cell.mill(DOOR)[0].error_code == NodeDeadError.code)
        result, _ = cell.mill(DOOR)
        assert "/door_localizer is dead" in result.message


def test_an_executable_ends_with_one_sentence_on_what_ros_cannot_read(tmp_path: Path) -> None:
    broken = tmp_path / "broken.yaml"
    broken.write_text("door_localizer: [1\n")
    for arguments in (["--log-level", "loud"], ["--params-file", str(broken)]):
        command = [executable("door_localizer"), "--ros-args", *arguments]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
        assert ended.returncode == 2, ended.stderr
        assert arguments[1] in ended.stderr
        assert "Traceback" not in ended.stderr
