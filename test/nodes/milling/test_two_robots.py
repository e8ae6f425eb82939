"""One goal for one door, milled by two robots: two path generators, bridges and controllers in namespaces."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from doormill_ros.abb.target_file.target_file import read_target_file
from doormill_ros.cell.errors import NodeInactiveError
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.nodes.one_process.cell import CellOptions, run_once
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.replay.replay import replay_bag
from doormill_ros.report.run_report import write_report
from support.cell_processes import executable, free_port
from support.waiting import LIMIT

DOOR = "standard_door"


def heard(folder: Path) -> dict[str, list[Any]]:
    """Messages by topic, as the recorder heard them."""
    found: dict[str, list[Any]] = {}
    for item in read_bag(folder / "bag"):
        found.setdefault(item.topic, []).append(item.message)
    return found


def states(found: dict[str, list[Any]], robot: str) -> list[str]:
    """What the handshake of a robot went through."""
    return [message.state for message in found[f"/{robot}/abb/status"]]


@dataclass(frozen=True)
class Milled:
    """What a run of the tool left: its folder, its summary, and what the page showed last."""

    folder: Path
    summary: dict[str, Any]
    shown: dict[str, Any]


@pytest.fixture(scope="module")
def milled(tmp_path_factory: pytest.TempPathFactory) -> Milled:
    """The tool with two robots and a page, until its door is milled; it is the dearest run of all."""
    folder, port = tmp_path_factory.mktemp("two") / "run", free_port()
    command = [executable("cell"), "--door", DOOR, "--robots", "2", "--ui", str(port), "--out", str(folder)]
    environment = {**os.environ, "XDG_DATA_HOME": str(folder.parent), "ROS_LOG_DIR": str(folder.parent)}
    log = folder.parent / "log.txt"
    with log.open("wb") as stream:
        process = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT, env=environment)
    try:
        shown = _shown_last(port, process, log)
        process.send_signal(signal.SIGINT)
        assert process.wait(LIMIT) == 0, log.read_text()
    finally:
        process.kill()
        process.wait()
    return Milled(folder, json.loads((folder / "summary.json").read_text()), shown)


def _shown_last(port: int, process: subprocess.Popen[bytes], log: Path) -> dict[str, Any]:
    """The page's content once the run has ended and its last messages have come."""
    shown: dict[str, Any] = {}

    def whole() -> bool:
        ended = bool(shown.get("history")) and "stays up for the operator's page" in log.read_text()
        # A refused door is drawn without anything measured.
        if not ended or not shown["history"][0]["success"]:
            return ended
        measured = shown["drawing"] and all(one["deviation"] >= 0.0 for one in shown["drawing"]["features"])
        return bool(measured and all(robot["does"] == "share" for robot in shown["robots"]))

    deadline = time.monotonic() + LIMIT
    while not whole():
        assert time.monotonic() < deadline, (shown, log.read_text())
        assert process.poll() is None, log.read_text()
        time.sleep(0.1)
        with suppress(httpx.TransportError):
            shown = httpx.get(f"http://127.0.0.1:{port}/state", timeout=LIMIT).json()
    return shown


def test_two_robots_mill_a_door_and_the_second_begins_when_the_first_is_home(milled: Milled) -> None:
    folder, summary = milled.folder, milled.summary
    run_id, touched, error = summary["run_id"], summary["touched"], summary["feature_error"]
    assert summary["success"], summary["message"]
    assert summary["measured"]
    assert error["corrected_max"] < error["tolerance"]
    # The judge saw what both did, and neither touched the other or anything else.
    assert touched["samples"] == 0
    files = [folder / "targets" / f"robot{number}" / f"{run_id}.txt" for number in (1, 2)]
    shares = [read_target_file(file.read_bytes()) for file in files]
    assert [share.run_id for share in shares] == [run_id] * 2
    cut = [
        {line.split()[1] for line in f.read_text().splitlines() if line.startswith("#feature")} for f in files
    ]
    assert all(cut)
    assert {"hinge_1", "hinge_2", "hinge_3"} <= cut[0]
    assert "lock_case" in cut[1] - cut[0]
    found = heard(folder)
    executed = [found[f"/robot{number}/simulation/executed_path"][-1] for number in (1, 2)]
    assert touched["judged"] == sum(len(path.time) for path in executed)
    # By the bridges' own stamps, one clock for both, the second took up its file after the first had told of its end.
    (first,) = [m for m in found["/robot1/share/result"] if m.run_id == run_id]
    writing = [m for m in found["/robot2/abb/status"] if m.state == "writing" and m.run_id == run_id]
    assert first.success
    assert all(seconds_of(first.header.stamp) < seconds_of(m.header.stamp) for m in writing)
    assert writing
    (result,) = found["/run/result"]
    assert (result.run_id, result.success) == (run_id, True)
    replayed = replay_bag(folder / "bag")
    assert replayed.found == []
    for number in (1, 2):
        targets = f"/robot{number}/path/targets"
        assert replayed.counts[targets] == len(found[targets])
        assert replayed.counts[f"/robot{number}/abb/target_file"] == 1


def test_the_summary_of_one_robot_tells_what_two_would_need(tmp_path: Path) -> None:
    summary = run_once(DOOR, tmp_path, CellOptions())
    assert summary.success, summary.message
    told = json.loads((tmp_path / "summary.json").read_text())["cycle"]
    assert told["two"] < told["allowed"] < told["one"]
    write_report(tmp_path / "bag", tmp_path / "report.html")
    assert summary.cycle.sentence in (tmp_path / "report.html").read_text()


def test_without_the_bridge_of_one_robot_nothing_is_milled(tmp_path: Path) -> None:
    missing = {"robot2/abb_bridge": {"autostart": False}}
    summary = run_once(DOOR, tmp_path, CellOptions(missing, robots=2))
    assert (summary.success, summary.error_code) == (False, NodeInactiveError.code)
    assert "second robot" in summary.message
    # Neither a copy nor what a controller reads.
    assert not list(tmp_path.rglob("*.txt"))


def test_a_first_robot_that_stops_with_a_fault_keeps_the_second_one_still(tmp_path: Path) -> None:
    faulty = {"robot1/controller_simulator": {"spindle_works": False}}
    summary = run_once(DOOR, tmp_path, CellOptions(faulty, robots=2))
    assert (summary.success, summary.error_code) == (False, 491)
    assert "first robot" in summary.message
    found = heard(tmp_path)
    assert "milling" in states(found, "robot1")
    assert "milling" not in states(found, "robot2")
    assert not any(message.data for message in found["/robot2/abb/ready"])


def test_the_page_tells_of_both_robots_and_of_the_door_they_milled(milled: Milled) -> None:
    shown = milled.shown
    assert shown["step"]["key"] == "done_both"
    assert shown["history"][0]["run_id"] == milled.summary["run_id"]
    for feature in shown["drawing"]["features"]:
        assert feature["came_to"] == "within"
        # Of each robot's own program; a half of a through hole is in both.
        assert all(0.0 <= share["begin"] < share["end"] for share in feature["shares"])
    assert {share["robot"] for one in shown["drawing"]["features"] for share in one["shares"]} == {1, 2}
    assert shown["faults"] == []
