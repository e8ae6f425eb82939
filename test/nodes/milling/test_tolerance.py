"""A robot far softer than assumed mills a door that is no good: nothing and nobody calls it a success."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from doormill_ros.operator.history.history import load_history
from doormill_ros.recording.bag_reader import read_bag
from support.cell_processes import executable
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
SOFT = """
- {cause: joint_stiffness, where: joint 1, parameters: {stiffness: 6.0e+4}}
- {cause: joint_stiffness, where: joint 2, parameters: {stiffness: 6.0e+4}}
"""
WORDS = "milled, out of tolerance"
OUT_OF_TOLERANCE = 807


@dataclass
class Ended:
    """The tool after its end."""

    folder: Path
    status: int
    output: str
    page: dict[str, Any]

    @property
    def summary(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads((self.folder / "summary.json").read_text())
        return document


@pytest.fixture(scope="module")
def soft(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ended]:
    """The cell with a soft robot, with its page, until it is interrupted."""
    folder = tmp_path_factory.mktemp("soft")
    (folder / "soft.yaml").write_text(SOFT)
    command = [executable("cell"), "--door", DOOR, "--out", "run", "--effects", "soft.yaml", "--ui", "0"]
    environment = {**os.environ, "XDG_DATA_HOME": str(folder / "data"), "ROS_LOG_DIR": str(folder / "ros")}
    output, log = folder / "output.txt", folder / "log.txt"
    with open(output, "wb") as out, open(log, "wb") as err:
        process = subprocess.Popen(command, cwd=folder, stdout=out, stderr=err, env=environment)
    try:
        deadline = time.monotonic() + LIMIT
        while "the cell stays up" not in output.read_text():
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.1)
        url = re.search(r"operator's page at (http://127\.0\.0\.1:\d+)/", log.read_text())
        assert url
        page: dict[str, Any] = {}
        while not page.get("history"):
            assert time.monotonic() < deadline, page
            page = httpx.get(f"{url[1]}/state", timeout=LIMIT).json()
        process.send_signal(signal.SIGINT)
        status = process.wait(LIMIT)
        yield Ended(folder / "run", status, output.read_text(), page)
    finally:
        process.kill()
        process.wait()


def worst(ended: Ended) -> tuple[str, float]:
    """The worst feature of the recorded inspection, and how far off it is [m]."""
    (milled,) = [m.message for m in read_bag(ended.folder / "bag", ["/simulation/milled_door"])]
    return max(((f.feature, f.corrected_max) for f in milled.features), key=lambda pair: pair[1])


def test_the_robot_was_soft_enough(soft: Ended) -> None:
    assert worst(soft)[1] > 0.5e-3


def test_the_exit_status_and_the_terminal_say_so(soft: Ended) -> None:
    feature, deviation = worst(soft)
    assert soft.status == 3
    assert WORDS in soft.output
    assert f"{feature} is {1e3 * deviation:.2f} mm off" in soft.output


def test_the_result_says_so(soft: Ended) -> None:
    feature, deviation = worst(soft)
    (result,) = [m.message for m in read_bag(soft.folder / "bag", ["/run/result"])]
    assert (result.success, result.error_code, result.measured) == (False, OUT_OF_TOLERANCE, True)
    assert (result.worst_feature, result.deviation, result.tolerance) == (feature, deviation, 0.5e-3)
    assert WORDS in result.message
    assert Path(result.target_file).is_file()


def test_the_summary_says_so(soft: Ended) -> None:
    feature, deviation = worst(soft)
    summary = soft.summary
    assert (summary["success"], summary["error_code"]) == (False, OUT_OF_TOLERANCE)
    assert (summary["outcome"], summary["measured"]) == (WORDS, True)
    assert (summary["feature_error"]["feature"], summary["feature_error"]["corrected_max"]) == (
        feature,
        deviation,
    )


def test_the_report_says_so(soft: Ended) -> None:
    report = (soft.folder / "report.html").read_text(encoding="utf-8")
    assert f"Door {DOOR}: {WORDS}" in report
    assert worst(soft)[0] in report


def test_page_and_history_say_so(soft: Ended) -> None:
    (run,) = soft.page["history"]
    assert (run["outcome"], run["error_code"]) == (WORDS, OUT_OF_TOLERANCE)
    assert worst(soft)[0] in soft.page["refusal"]
    assert "out of tolerance" in soft.page["next_step"]
    (kept,) = load_history(soft.folder)
    assert kept.outcome == WORDS
