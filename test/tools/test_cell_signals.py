"""The tool `cell` ends of a signal without a traceback, wherever between its first import and a door it comes."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from support.cell_processes import executable
from support.waiting import LIMIT

#: What nodes log while all is well and of a door that is given up, what is told of a robot, and the stages of a door.
USUAL = re.compile(
    r"\[INFO\] \[|\[WARN\] .* (the run was canceled|the bridge was deactivated by its operator$)"
    r"|handshake, \w+: the bridge was deactivated by its operator$"
    r"|ABB IRB \S+: nobody measured|\[ *\d+%\] "
)


def mapped(library: str) -> Callable[[int, str], bool]:
    """Whether a process has begun to load a library."""
    return lambda pid, _: library in Path(f"/proc/{pid}/maps").read_text(encoding="utf-8")


def said(words: str) -> Callable[[int, str], bool]:
    """Whether it has said something."""
    return lambda _, output: words in output


#: Points on the way, in their order, by what shows that one is reached; and whether there is something to close.
POINTS: dict[str, tuple[Callable[[int, str], bool], bool]] = {
    "numpy is loaded": (mapped("_multiarray_umath"), False),
    "rclpy is loaded": (mapped("_rclpy_pybind11"), False),
    "scipy is loaded": (mapped("_highs"), False),
    "OpenCV is loaded": (mapped("cv2.abi3"), False),
    "matplotlib is loaded": (mapped("ft2font"), False),
    "the bag is open": (said("recording into"), True),
    "the bridge is active": (said("[abb_bridge]: active"), True),
    "the door is milled": (said("%] "), True),
}


@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
def test_a_signal_ends_it_in_one_line(number: signal.Signals, point: str, tmp_path: Path) -> None:
    reached, running = POINTS[point]
    command = [executable("cell"), "--door", "thesis_190_0deg", "--out", "run"]
    log = tmp_path / "log.txt"
    with open(log, "wb") as file:
        process = subprocess.Popen(
            command,
            cwd=tmp_path,
            stdout=file,
            stderr=file,
            env={**os.environ, "ROS_LOG_DIR": str(tmp_path / "ros")},
            start_new_session=True,
        )
    try:
        deadline = time.monotonic() + LIMIT
        while not reached(process.pid, log.read_text(encoding="utf-8")):
            assert process.poll() is None, log.read_text(encoding="utf-8")
            assert time.monotonic() < deadline, log.read_text(encoding="utf-8")
            time.sleep(0.002)
        os.killpg(process.pid, number)  # as a terminal does
        status = process.wait(LIMIT)
    finally:
        process.kill()
        process.wait()
    lines = [line for line in log.read_text(encoding="utf-8").splitlines() if not USUAL.match(line)]
    # A shell shows 130 and 143 of a process that died of these signals, too.
    in_order = running and number == signal.SIGTERM
    assert status == (128 + number if in_order else -number), lines
    assert lines == (["interrupted"] if running and number == signal.SIGINT else [])
