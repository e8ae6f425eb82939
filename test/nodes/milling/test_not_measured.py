"""A milled door of which nobody says how it came out is no success of a simulated run."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import rclpy

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import RunVerdict
from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.nodes.one_process import cell as whole_cell
from doormill_ros.nodes.one_process.cell_driver import NOT_INSPECTED, CellDriver
from doormill_ros.report import run_report
from doormill_ros.tools.cell import main

DOOR = "thesis_190_0deg"


@pytest.fixture
def driver() -> Iterator[CellDriver]:
    rclpy.init()
    node = CellDriver()
    yield node
    node.destroy_node()
    rclpy.shutdown()


def ended(measured: bool) -> MillDoor.Result:
    return MillDoor.Result(success=True, measured=measured, run_id="r1", message="door milled")


def test_a_door_that_nobody_measured_is_told_as_a_stage_without_an_answer(
    driver: CellDriver, tmp_path: Path
) -> None:
    summary = driver._summary(DOOR, RunFolder(tmp_path), ended(False))
    assert (summary.success, summary.error_code, summary.message) == (False, 801, NOT_INSPECTED)
    assert (summary.measured, summary.outcome) == (False, "milled, not measured")
    summary.write(tmp_path / "summary.json")
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "milled, not measured"


def test_a_measured_door_is_a_success(driver: CellDriver, tmp_path: Path) -> None:
    summary = driver._summary(DOOR, RunFolder(tmp_path), ended(True))
    assert (summary.success, summary.error_code, summary.message) == (True, 0, "door milled")
    assert summary.outcome == "milled"


def test_what_the_judge_found_counts_before_a_missing_measurement(driver: CellDriver, tmp_path: Path) -> None:
    driver._keep(
        "simulation/verdict", RunVerdict(run_id="r1", error_code=850, message="the arm met the door")
    )
    summary = driver._summary(DOOR, RunFolder(tmp_path), ended(False))
    assert (summary.success, summary.message) == (False, "the arm met the door")


@pytest.mark.parametrize(
    ("success", "code", "outcome", "status"),
    [
        (True, 0, "milled", 0),
        (False, 807, "milled, out of tolerance", 3),
        (False, 801, "milled, not measured", 1),
        (False, 201, "refused (201)", 1),
    ],
)
def test_the_exit_status_tells_how_the_run_ended(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, success: bool, code: int, outcome: str, status: int
) -> None:
    summary = RunSummary(DOOR, success, "told", code, bag="bag", report="report.html")
    monkeypatch.setattr(whole_cell, "run_once", lambda *_: replace(summary, outcome=outcome))
    monkeypatch.setattr(run_report, "write_report", lambda *_: None)
    assert main(["--door", DOOR, "--out", str(tmp_path)]) == status
